// Rows of particles turned into columns of pairs, and back.
#pragma once

#include "engine/kernel/kernel.hpp"
#include "engine/kernel/vector.hpp"
#include "engine/state.hpp"

namespace loam::engine {
namespace {

struct Column3 {
    Column x, y, z;
};
LOAM_INLINE Column dot(const Column3& a, const Column3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
LOAM_INLINE Column3 cross(const Column3& a, const Column3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
LOAM_INLINE Column3 scaled(Column a, const Column3& b) {
    return {a * b.x, a * b.y, a * b.z};
}
LOAM_INLINE Column3 plus_scaled(const Column3& a, Column b, const Column3& c) {
    return {a.x + b * c.x, a.y + b * c.y, a.z + b * c.z};
}
LOAM_INLINE Column3 minus_scaled(const Column3& a, Column b, const Column3& c) {
    return {a.x - b * c.x, a.y - b * c.y, a.z - b * c.z};
}
LOAM_INLINE Column3 minus(const Column3& a, const Column3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
LOAM_INLINE Column3 along_gradient(const double* L, const Column3& d) {
    return {L[0] * d.x + L[1] * d.y + L[2] * d.z, L[3] * d.x + L[4] * d.y + L[5] * d.z,
            L[6] * d.x + L[7] * d.y + L[8] * d.z};
}
template <class Row>
LOAM_INLINE double* row_of(Row* rows, std::uint32_t offset) {
    static_assert(sizeof(Row) == row_bytes);
    return reinterpret_cast<double*>(reinterpret_cast<char*>(rows) + offset);
}
template <class Row>
LOAM_INLINE const double* row_of(const Row* rows, std::uint32_t offset) {
    static_assert(sizeof(Row) == row_bytes);
    return reinterpret_cast<const double*>(reinterpret_cast<const char*>(rows) + offset);
}

/// Rows of j minus rows of i as columns: distance in 0..2, radius in 3, velocity in 4..6.
LOAM_INLINE void gather_differences(const ContactArguments& a, std::size_t k, Column (&columns)[8]) {
    v8 r[lanes];
    for (std::size_t l = 0; l < lanes; ++l)
        r[l] = load8(row_of(a.particles, a.row_j[k + l])) - load8(row_of(a.particles, a.row_i[k + l]));
    if (!all_equal(a.image + k, image_home))  // such pairs stand together in the list
        for (std::size_t l = 0; l < lanes; ++l) r[l] += load8(a.shifts + 8 * a.image[k + l]);
    to_columns(r, columns);
}

/// Sums of R·spin of both particles.
LOAM_INLINE Column3 gather_spin_sums(const ContactArguments& a, std::size_t k) {
    v4 rows[lanes];
    for (std::size_t l = 0; l < lanes; ++l)
        rows[l] = load4(row_of(a.spins, a.row_i[k + l])) + load4(row_of(a.spins, a.row_j[k + l]));
    HalfRows sums;
    sums.set_rows(rows);
    sums.transpose();
    return {sums.r[0], sums.r[1], sums.r[2]};
}

/// Spin of j minus spin of i.
LOAM_INLINE Column3 gather_spin_differences(const ContactArguments& a, std::size_t k) {
    v4 rows[lanes];
    for (std::size_t l = 0; l < lanes; ++l)
        rows[l] = load4(row_of(a.spins, a.row_j[k + l]) + 4) - load4(row_of(a.spins, a.row_i[k + l]) + 4);
    HalfRows differences;
    differences.set_rows(rows);
    differences.transpose();
    return {differences.r[0], differences.r[1], differences.r[2]};
}

/// Adds f to the forces on i and its opposite to those on j.
LOAM_INLINE void scatter_forces(const ContactArguments& a, std::size_t k, const Column3& f) {
    HalfRows rows = {{f.x, f.y, f.z, splat(0.0)}};
    rows.transpose();
    for (int l = 0; l < lanes; ++l) {
        double *i = row_of(a.forces, a.row_i[k + l]), *j = row_of(a.forces, a.row_j[k + l]);
        const v4 row = rows.row(l);
        store4(i, load4(i) + row);
        store4(j, load4(j) - row);
    }
}

/// The same with moments over the radii, which are equal on i and j.
LOAM_INLINE void scatter_forces_and_moment(const ContactArguments& a, std::size_t k, const Column3& f,
                                           const Column3& moment) {
    HalfRows forces = {{f.x, f.y, f.z, splat(0.0)}}, moments = {{moment.x, moment.y, moment.z, splat(0.0)}};
    forces.transpose();
    moments.transpose();
    const v8 sign = join(row4(-1, -1, -1, -1), row4(1, 1, 1, 1));
    for (int l = 0; l < lanes; ++l) {
        double *i = row_of(a.forces, a.row_i[k + l]), *j = row_of(a.forces, a.row_j[k + l]);
        const v8 row = whole_row(forces, moments, l);
        store8(i, load8(i) + row);
        store8(j, load8(j) + row * sign);
    }
}

/// The same with moments over the radii that differ.
LOAM_INLINE void scatter_forces_and_moments(const ContactArguments& a, std::size_t k, const Column3& f,
                                            const Column3& moment_i, const Column3& moment_j) {
    HalfRows rows = {{f.x, f.y, f.z, splat(0.0)}}, of_i = {{moment_i.x, moment_i.y, moment_i.z, splat(0.0)}},
             of_j = {{-moment_j.x, -moment_j.y, -moment_j.z, splat(0.0)}};
    rows.transpose();
    of_i.transpose();
    of_j.transpose();
    for (int l = 0; l < lanes; ++l) {
        double *i = row_of(a.forces, a.row_i[k + l]), *j = row_of(a.forces, a.row_j[k + l]);
        store8(i, load8(i) + whole_row(rows, of_i, l));
        store8(j, load8(j) - whole_row(rows, of_j, l));
    }
}

}  // namespace
}  // namespace loam::engine
