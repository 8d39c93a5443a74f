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

constexpr std::size_t no_bond = static_cast<std::size_t>(-1);
constexpr std::size_t no_pair = static_cast<std::size_t>(-1);
constexpr std::size_t block = 64;  // pairs that are interleaved

Vector3i image_vector(std::int32_t index) {
    return {index / 9 - 1, (index / 3) % 3 - 1, index % 3 - 1};
}

/// One number for an image; those of old pairs may reach ±3 after wrapping.
std::int32_t image_code(const Vector3i& n) {
    return (n.x() + 3) * 64 + (n.y() + 3) * 8 + (n.z() + 3);
}

Vector3i decode_image(std::int32_t code) {
    return {code / 64 - 3, code / 8 % 8 - 3, code % 8 - 3};
}

/// Moves every particle into the cell and notes by how many cells; returns the largest radius.
double wrap(AlignedVector<ParticleRow>& particles, std::size_t count, const Matrix3d& cell,
            const Matrix3d& inverse, std::vector<Vector3i>& moved) {
    double largest = 0;
    moved.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        double* at = particles[p].x;
        largest = std::max(largest, particles[p].radius);
        const Vector3d f = inverse * Vector3d(at[0], at[1], at[2]);
        moved[p].setZero();
        if (f.minCoeff() >= 0 && f.maxCoeff() < 1) continue;
        for (int k = 0; k < 3; ++k) moved[p][k] = static_cast<int>(std::floor(f[k]));
        const Vector3d shift = cell * moved[p].cast<double>();
        for (int k = 0; k < 3; ++k) at[k] -= shift[k];
    }
    return largest;
}

/// The contacts of the old list by their first particle.
void collect_bonds(const PairList& old, std::size_t count, RebuildBuffers& b) {
    b.bond_start.assign(count + 2, 0);
    for (std::size_t k = 0; k < old.padded(); ++k)
        if (old.bond[k] != bond_none) ++b.bond_start[static_cast<std::size_t>(old.i[k]) + 2];
    for (std::size_t p = 2; p < b.bond_start.size(); ++p) b.bond_start[p] += b.bond_start[p - 1];
    b.bonds.resize(b.bond_start.back());
    for (std::size_t k = 0; k < old.padded(); ++k) {
        if (old.bond[k] == bond_none) continue;
        const auto i = static_cast<std::size_t>(old.i[k]), j = static_cast<std::size_t>(old.j[k]);
        const Vector3i n = image_vector(old.image[k]) + b.moved[j] - b.moved[i];
        b.bonds[b.bond_start[i + 1]++] = {old.j[k], image_code(n), k, false};
    }
}

/// Looks for the bonds of the near pairs first..last and moves bonded pairs to the first section.
void find_bonds(RebuildBuffers& b, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
        NearPair& pair = b.near[k];
        const auto i = static_cast<std::size_t>(pair.i);
        for (std::size_t h = b.bond_start[i]; h < b.bond_start[i + 1]; ++h) {
            RebuildBuffers::Bond& bond = b.bonds[h];
            if (bond.j != pair.j || bond.image_code != image_code(image_vector(pair.image))) continue;
            bond.found = true;
            b.bond_of[k] = bond.at;
            pair.section = 0;
        }
    }
}

constexpr std::size_t pieces = 16;  // that threads share

/// Finds the bond of every near pair and adds the pairs whose bond reaches farther than the skin.
void join_bonds(RebuildBuffers& b, Crew& crew, std::size_t& pairs) {
    b.bond_of.assign(pairs + b.bonds.size(), no_bond);
    crew.run(pieces, [&](std::size_t p) { find_bonds(b, p * pairs / pieces, (p + 1) * pairs / pieces); });
    if (b.near.size() < pairs + b.bonds.size()) b.near.resize(pairs + b.bonds.size());
    for (std::size_t i = 0; i + 2 < b.bond_start.size(); ++i)
        for (std::size_t h = b.bond_start[i]; h < b.bond_start[i + 1]; ++h) {
            if (b.bonds[h].found) continue;
            const Vector3i n = decode_image(b.bonds[h].image_code);
            if (n.cwiseAbs().maxCoeff() > 1)
                throw std::runtime_error("a contact reaches across more than one periodic cell");
            b.bond_of[pairs] = b.bonds[h].at;
            b.near[pairs++] = {static_cast<std::int32_t>(i), b.bonds[h].j, image_index(n.x(), n.y(), n.z()),
                               0};
        }
}

/// The order of the new list: by part and section, pairs across the boundary first, and within every block of
/// 64 such that the eight pairs of a group, which add their forces one after the other, stood apart before:
/// they seldom share a particle. order[place] is the near pair, or none for padding.
void order_pairs(RebuildBuffers& b, std::size_t pairs, std::size_t parts, PairList& out) {
    constexpr std::size_t ranks = 2 * gap_sections;
    const auto rank = [&](std::size_t k) {
        return ranks * static_cast<std::size_t>(b.part_of[k]) +
               2 * static_cast<std::size_t>(b.near[k].section) + (b.near[k].image == image_home ? 1u : 0u);
    };
    std::vector<std::size_t>& next = b.next_place;
    next.assign(ranks * parts + 1, 0);
    for (std::size_t k = 0; k < pairs; ++k) ++next[rank(k)];
    out.parts.resize(parts);
    std::size_t place = 0;
    for (std::size_t p = 0; p < parts; ++p) {
        PairList::Part& part = out.parts[p];
        part.first = place;
        for (std::size_t r = 0; r < ranks; ++r) {
            const std::size_t size = next[ranks * p + r];
            next[ranks * p + r] = place;
            place += size;
            part.section_end[r / 2] = place;
        }
        place = part.last = (place + 7) / 8 * 8;
    }
    b.order.assign(place, no_pair);
    for (std::size_t k = 0; k < pairs; ++k) {
        const PairList::Part& part = out.parts[static_cast<std::size_t>(b.part_of[k])];
        const std::size_t at = next[rank(k)]++ - part.first, base = at / block * block, within = at % block;
        const bool whole = part.first + base + block <= part.section_end.back();
        b.order[part.first + (whole ? base + within % 8 * 8 + within / 8 : at)] = k;
    }
    out.resize_padded(place);
    out.count = pairs;
}

void fill_pairs(const RebuildBuffers& b, const AlignedVector<ParticleRow>& particles, std::size_t first,
                std::size_t last, PairList& out) {
    const PairList& old = b.old;
    for (std::size_t k = first; k < last; ++k) {
        if (b.order[k] == no_pair) continue;
        const NearPair& pair = b.near[b.order[k]];
        out.i[k] = pair.i;
        out.j[k] = pair.j;
        out.row_i[k] = row_offset(pair.i);
        out.row_j[k] = row_offset(pair.j);
        out.image[k] = pair.image;
        const double r = particles[static_cast<std::size_t>(pair.i)].radius;
        const double s = particles[static_cast<std::size_t>(pair.j)].radius;
        out.radius_sum[k] = r + s;
        out.reduced_radius[k] = r * s / (r + s);
        out.area[k] = std::min(r, s) * std::min(r, s);
        const std::size_t at = b.bond_of[b.order[k]];
        for (std::size_t q = 0; q < 3; ++q) out.shear[q][k] = at == no_bond ? 0.0 : old.shear[q][at];
        out.bond[k] = at == no_bond ? bond_none : old.bond[at];
        for (std::size_t q = 0; q < out.further.size(); ++q)
            out.further[q][k] = at == no_bond ? 0.0 : old.further[q][at];
    }
}

}  // namespace

void fill_with_dummies(PairList& pairs, std::size_t first, std::size_t last, std::size_t count) {
    for (std::size_t k = first; k < last; ++k) {
        pairs.i[k] = static_cast<std::int32_t>(count);
        pairs.j[k] = static_cast<std::int32_t>(count + 1);
        pairs.row_i[k] = row_offset(pairs.i[k]);
        pairs.row_j[k] = row_offset(pairs.j[k]);
        pairs.image[k] = image_home;
        pairs.radius_sum[k] = 1e-3;  // what is divided by must not be zero
        pairs.reduced_radius[k] = pairs.area[k] = 1.0;
        pairs.shear[0][k] = pairs.shear[1][k] = pairs.shear[2][k] = 0.0;
        pairs.bond[k] = bond_none;
        for (auto& values : pairs.further) values[k] = 0.0;
    }
}

void PairList::resize_padded(std::size_t n) {
    count = n;
    const std::size_t padded_size = (n + 7) / 8 * 8;
    for (auto* a : {&i, &j, &image}) a->resize(padded_size);
    for (auto* a : {&row_i, &row_j}) a->resize(padded_size);
    for (auto* a : {&radius_sum, &reduced_radius, &area, &shear[0], &shear[1], &shear[2], &bond})
        a->resize(padded_size);
    for (auto& values : further) values.resize(padded_size);
}

std::size_t PairList::within_reach(const Part& part, double motion) const {
    std::size_t s = 0;
    while (s + 1 < gap_sections && section_gap[s + 1] <= motion) ++s;
    const std::size_t reached = part.section_end[s] - part.first;
    return std::min(part.last, part.first + (reached + block - 1) / block * block);
}

std::int32_t gap_section(double closeness, double skin) {
    const double scaled = (closeness - 1) / ((1 + skin) * (1 + skin) - 1) * (gap_sections - 1);
    if (scaled < 0) return 0;
    return std::min(1 + static_cast<std::int32_t>(scaled), gap_sections - 1);
}

void rebuild_pairs(PairList& pairs, RebuildBuffers& buffers, AlignedVector<ParticleRow>& particles,
                   std::size_t count, const Matrix3d& cell, double skin, Slabs& slabs, Crew& crew) {
    const Matrix3d inverse = cell.inverse();
    const double largest = wrap(particles, count, cell, inverse, buffers.moved);
    std::swap(pairs, buffers.old);
    pairs.further.resize(buffers.old.further.size());
    collect_bonds(buffers.old, count, buffers);
    buffers.grid.fill(particles, count, inverse, 2 * largest * (1 + skin));
    std::size_t found = buffers.grid.find_pairs(cell, skin, crew, buffers.near);
    join_bonds(buffers, crew, found);
    slabs.sort_out(particles, count, inverse, buffers.near, found, buffers.part_of);
    order_pairs(buffers, found, slabs.parts(), pairs);
    const std::size_t groups = pairs.padded() / 8;
    crew.run(pieces, [&](std::size_t p) {
        fill_pairs(buffers, particles, p * groups / pieces * 8, (p + 1) * groups / pieces * 8, pairs);
    });
    for (const PairList::Part& part : pairs.parts)
        fill_with_dummies(pairs, part.section_end.back(), part.last, count);
    for (int s = 1; s < gap_sections; ++s)
        pairs.section_gap[static_cast<std::size_t>(s)] =
            std::sqrt(1 + (s - 1) * ((1 + skin) * (1 + skin) - 1) / (gap_sections - 1)) - 1;
}

}  // namespace loam::engine
