#include "engine/neighbours.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

/// A pair with its sort key: (i, j, image), i < j. Images of old pairs may reach ±2 after wrapping.
struct Pair {
    std::uint64_t key;
    std::int32_t i, j, image;
};

std::uint64_t pair_key(std::int32_t i, std::int32_t j, const Vector3i& n) {
    const auto shift = static_cast<std::uint64_t>((n.x() + 3) * 64 + (n.y() + 3) * 8 + (n.z() + 3));
    return (static_cast<std::uint64_t>(i) << 36) | (static_cast<std::uint64_t>(j) << 9) | shift;
}

Vector3i image_vector(std::int32_t index) {
    return {index / 9 - 1, (index / 3) % 3 - 1, index % 3 - 1};
}

Vector3d position(const ParticleRow& row) {
    return {row.x[0], row.x[1], row.x[2]};
}

/// Moves every particle into the cell; returns by how many cells each was moved.
std::vector<Vector3i> wrap(AlignedVector<ParticleRow>& particles, std::size_t count, const Matrix3d& cell,
                           const Matrix3d& inverse) {
    std::vector<Vector3i> moved(count, Vector3i::Zero());
    for (std::size_t p = 0; p < count; ++p) {
        const Vector3d f = inverse * position(particles[p]);
        for (int k = 0; k < 3; ++k) moved[p][k] = static_cast<int>(std::floor(f[k]));
        const Vector3d x = position(particles[p]) - cell * moved[p].cast<double>();
        for (int k = 0; k < 3; ++k) particles[p].x[k] = x[k];
    }
    return moved;
}

/// Bins of a grid in fractional coordinates, at least as thick as the largest reach.
struct Grid {
    Vector3i size;
    std::vector<std::int32_t> start, member;  // compressed rows: members of bin b are start[b]..start[b+1]
    std::vector<Vector3i> bin_of;

    Grid(const AlignedVector<ParticleRow>& particles, std::size_t count, const Matrix3d& inverse,
         double reach) {
        for (int k = 0; k < 3; ++k) {
            // The distance of opposite faces of the cell is one over the length of the reciprocal vector.
            const double thickness = 1.0 / inverse.row(k).norm();
            if (thickness < reach)
                throw std::runtime_error("the periodic cell has become thinner than two particles (" +
                                         std::to_string(thickness) + " m)");
            size[k] = std::clamp(static_cast<int>(thickness / reach), 1, 64);
        }
        start.assign(static_cast<std::size_t>(size.prod()) + 1, 0);
        bin_of.resize(count);
        for (std::size_t p = 0; p < count; ++p) {
            const Vector3d f = inverse * position(particles[p]);
            for (int k = 0; k < 3; ++k)
                bin_of[p][k] = std::clamp(static_cast<int>(f[k] * size[k]), 0, size[k] - 1);
            ++start[index(bin_of[p]) + 1];
        }
        for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
        member.resize(count);
        std::vector<std::int32_t> cursor(start.begin(), start.end() - 1);
        for (std::size_t p = 0; p < count; ++p)
            member[static_cast<std::size_t>(cursor[index(bin_of[p])]++)] = static_cast<std::int32_t>(p);
    }

    std::size_t index(const Vector3i& b) const {
        return static_cast<std::size_t>((b.x() * size.y() + b.y()) * size.z() + b.z());
    }
};

/// All pairs closer than the skin. A bin is met under each of its periodic copies, so a cell of one or two
/// bins works.
std::vector<Pair> find_pairs(const AlignedVector<ParticleRow>& particles, std::size_t count,
                             const Matrix3d& cell, const Matrix3d& inverse, double skin) {
    double largest = 0;
    for (std::size_t p = 0; p < count; ++p) largest = std::max(largest, particles[p].radius);
    const Grid grid(particles, count, inverse, 2 * largest * (1 + skin));
    std::vector<Pair> pairs;
    for (std::size_t p = 0; p < count; ++p) {
        for (int offset = image_home; offset < image_count;
             ++offset) {  // half of the 27 neighbours, and the own bin
            Vector3i bin = grid.bin_of[p] + image_vector(offset), shift = Vector3i::Zero();
            for (int k = 0; k < 3; ++k) {
                if (bin[k] < 0) bin[k] += grid.size[k], shift[k] = -1;
                if (bin[k] >= grid.size[k]) bin[k] -= grid.size[k], shift[k] = 1;
            }
            const Vector3d origin = position(particles[p]) - cell * shift.cast<double>();
            const std::size_t b = grid.index(bin);
            for (std::int32_t m = grid.start[b]; m < grid.start[b + 1]; ++m) {
                const std::int32_t q = grid.member[static_cast<std::size_t>(m)],
                                   own = static_cast<std::int32_t>(p);
                if (q == own || (offset == image_home && q < own)) continue;
                const ParticleRow& other = particles[static_cast<std::size_t>(q)];
                const double reach = (particles[p].radius + other.radius) * (1 + skin);
                if ((position(other) - origin).squaredNorm() > reach * reach) continue;
                const bool ordered = own < q;
                const Vector3i n = ordered ? shift : Vector3i(-shift);
                const std::int32_t i = ordered ? own : q, j = ordered ? q : own;
                pairs.push_back({pair_key(i, j, n), i, j, image_index(n.x(), n.y(), n.z())});
            }
        }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.key < b.key; });
    return pairs;
}

struct History {
    std::uint64_t key;
    std::int32_t i, j;
    Vector3i image;
    double shear[3], bond;
};

/// The contacts of the old list, with their images as they are after wrapping, sorted by key.
std::vector<History> collect_history(const PairList& pairs, const std::vector<Vector3i>& moved) {
    std::vector<History> history;
    for (std::size_t k = 0; k < pairs.count; ++k) {
        if (pairs.bond[k] == bond_none) continue;
        const std::int32_t i = pairs.i[k], j = pairs.j[k];
        const Vector3i n = image_vector(pairs.image[k]) + moved[static_cast<std::size_t>(j)] -
                           moved[static_cast<std::size_t>(i)];
        history.push_back({pair_key(i, j, n),
                           i,
                           j,
                           n,
                           {pairs.shear[0][k], pairs.shear[1][k], pairs.shear[2][k]},
                           pairs.bond[k]});
    }
    std::sort(history.begin(), history.end(),
              [](const History& a, const History& b) { return a.key < b.key; });
    return history;
}

}  // namespace

void PairList::resize_padded(std::size_t n) {
    count = n;
    const std::size_t padded_size = (n + 7) / 8 * 8;
    for (auto* a : {&i, &j, &image}) a->assign(padded_size, 0);
    for (auto* a : {&radius_sum, &stiffness_length, &area, &shear[0], &shear[1], &shear[2], &bond})
        a->assign(padded_size, 0.0);
}

void rebuild_pairs(PairList& pairs, AlignedVector<ParticleRow>& particles, std::size_t count,
                   const Matrix3d& cell, double skin) {
    const Matrix3d inverse = cell.inverse();
    const std::vector<Vector3i> moved = wrap(particles, count, cell, inverse);
    const std::vector<History> history = collect_history(pairs, moved);
    std::vector<Pair> found = find_pairs(particles, count, cell, inverse, skin);
    // A contact in tension may have left the skin: it stays listed while its bond lives.
    const std::size_t within = found.size();
    for (const History& h : history) {
        const auto at = std::lower_bound(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(within),
                                         h.key, [](const Pair& p, std::uint64_t key) { return p.key < key; });
        if (at != found.begin() + static_cast<std::ptrdiff_t>(within) && at->key == h.key) continue;
        if (h.image.cwiseAbs().maxCoeff() > 1)
            throw std::runtime_error("a contact reaches across more than one periodic cell");
        found.push_back({h.key, h.i, h.j, image_index(h.image.x(), h.image.y(), h.image.z())});
    }
    std::sort(found.begin(), found.end(), [](const Pair& a, const Pair& b) { return a.key < b.key; });

    pairs.resize_padded(found.size());
    auto h = history.begin();
    for (std::size_t k = 0; k < found.size(); ++k) {
        const Pair& pair = found[k];
        pairs.i[k] = pair.i;
        pairs.j[k] = pair.j;
        pairs.image[k] = pair.image;
        const double a = particles[static_cast<std::size_t>(pair.i)].radius;
        const double b = particles[static_cast<std::size_t>(pair.j)].radius;
        pairs.radius_sum[k] = a + b;
        pairs.stiffness_length[k] = a * b / (a + b);
        pairs.area[k] = std::min(a, b) * std::min(a, b);
        while (h != history.end() && h->key < pair.key) ++h;
        if (h == history.end() || h->key != pair.key) continue;
        for (int q = 0; q < 3; ++q) pairs.shear[q][k] = h->shear[q];
        pairs.bond[k] = h->bond;
    }
    for (std::size_t k = found.size(); k < pairs.padded();
         ++k) {  // the two dummies, a metre apart, never touch
        pairs.i[k] = static_cast<std::int32_t>(count);
        pairs.j[k] = static_cast<std::int32_t>(count + 1);
        pairs.image[k] = image_home;
        pairs.radius_sum[k] = 1e-3;  // what is divided by must not be zero
        pairs.stiffness_length[k] = 1.0;
    }
}

}  // namespace loam::engine
