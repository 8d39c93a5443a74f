#include "engine/neighbour_grid.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace loam::engine {
namespace {

constexpr int cube = 4;  // bins are visited by cubes of this side: their particles fit the first-level cache

}  // namespace

void NeighbourGrid::fill(const AlignedVector<ParticleRow>& particles, std::size_t count,
                         const Eigen::Matrix3d& inverse, double reach) {
    for (int k = 0; k < 3; ++k) {
        // The distance of opposite faces of the cell is one over the length of the reciprocal vector.
        const double thickness = 1.0 / inverse.row(k).norm();
        if (!(thickness >= reach))
            throw std::runtime_error("the periodic cell has become thinner than two particles (" +
                                     std::to_string(thickness) + " m)");
        size_[static_cast<std::size_t>(k)] =
            static_cast<int>(std::min(64.0, std::max(1.0, std::floor(thickness / reach))));
    }
    const auto bins = static_cast<std::size_t>(size_[0] * size_[1] * size_[2]);
    start_.assign(bins + 1, 0);
    bin_of_.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        const double* at = particles[p].x;
        int bin[3];
        for (int k = 0; k < 3; ++k) {
            const double f = inverse(k, 0) * at[0] + inverse(k, 1) * at[1] + inverse(k, 2) * at[2];
            const int n = size_[static_cast<std::size_t>(k)];
            bin[k] = std::clamp(static_cast<int>(f * n), 0, n - 1);
        }
        bin_of_[p] = index(bin[0], bin[1], bin[2]);
        ++start_[static_cast<std::size_t>(bin_of_[p]) + 1];
    }
    for (std::size_t b = 1; b < start_.size(); ++b) start_[b] += start_[b - 1];
    cursor_.assign(start_.begin(), start_.end() - 1);
    for (auto* a : {&x_, &y_, &z_, &radius_}) a->resize(count);
    id_.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
        const auto place = static_cast<std::size_t>(cursor_[static_cast<std::size_t>(bin_of_[p])]++);
        id_[place] = static_cast<std::int32_t>(p);
        x_[place] = particles[p].x[0];
        y_[place] = particles[p].x[1];
        z_[place] = particles[p].x[2];
        radius_[place] = particles[p].radius;
    }
}

/// Half of the 26 bins around one, each met under each of its periodic copies, so that a cell of one or two
/// bins works. Bins along z are joined where they share their shift.
int NeighbourGrid::collect_runs(int x, int y, int z, const Eigen::Matrix3d& cell,
                                std::array<Run, 16>& runs) const {
    int n = 0;
    const auto add = [&](int bx, int by, int z_first, int z_last, int sx, int sy, int sz) {
        const Eigen::Vector3d s = cell * Eigen::Vector3d(sx, sy, sz);
        runs[static_cast<std::size_t>(n++)] = {start_[static_cast<std::size_t>(index(bx, by, z_first))],
                                               start_[static_cast<std::size_t>(index(bx, by, z_last)) + 1],
                                               image_index(sx, sy, sz),
                                               {s.x(), s.y(), s.z()}};
    };
    const auto wrapped = [](int b, int size, int& shift) {
        shift = b < 0 ? -1 : b >= size ? 1 : 0;
        return b - shift * size;
    };
    constexpr int columns[5][2] = {{0, 0}, {0, 1}, {1, -1}, {1, 0}, {1, 1}};
    for (const auto& column : columns) {
        int sx, sy;
        const int bx = wrapped(x + column[0], size_[0], sx), by = wrapped(y + column[1], size_[1], sy);
        const bool own = column[0] == 0 && column[1] == 0;
        int low = own ? z + 1 : z - 1, high = z + 1;
        if (low < 0) {
            add(bx, by, size_[2] - 1, size_[2] - 1, sx, sy, -1);
            low = 0;
        }
        if (high >= size_[2]) {
            add(bx, by, 0, 0, sx, sy, 1);
            high = size_[2] - 1;
        }
        if (low <= high) add(bx, by, low, high, sx, sy, 0);
    }
    return n;
}

/// Writes the places within reach of place `own` to the front of `out`; without a branch on the distance,
/// which no processor could foresee.
std::size_t NeighbourGrid::hits_in(std::size_t own, std::size_t first, std::size_t last, const double* shift,
                                   double stretch2, Hit* out) const {
    const double x = x_[own] - shift[0], y = y_[own] - shift[1], z = z_[own] - shift[2], r = radius_[own];
    const double *xs = x_.data(), *ys = y_.data(), *zs = z_.data(), *rs = radius_.data();
    std::size_t n = 0;
    for (std::size_t q = first; q < last; ++q) {
        const double dx = xs[q] - x, dy = ys[q] - y, dz = zs[q] - z, sum = r + rs[q];
        const double d2 = dx * dx + dy * dy + dz * dz, sum2 = sum * sum;
        out[n].place = static_cast<std::int32_t>(q);
        out[n].d2 = d2;
        n += d2 <= sum2 * stretch2 ? 1u : 0u;
    }
    return n;
}

void NeighbourGrid::search_bin(std::int32_t bin, const Run* runs, int run_count, double skin,
                               Found& found) const {
    const double stretch2 = (1 + skin) * (1 + skin);
    const auto first = static_cast<std::size_t>(start_[static_cast<std::size_t>(bin)]),
               last = static_cast<std::size_t>(start_[static_cast<std::size_t>(bin) + 1]);
    const double at_home[3] = {};
    std::vector<NearPair>& pairs = found.pairs;
    const Hit* near = found.hits.data();
    for (std::size_t own = first; own < last; ++own) {
        for (int r = -1; r < run_count; ++r) {  // the rest of the own bin, then the other runs
            const bool home = r < 0;
            const std::size_t hits = home ? hits_in(own, own + 1, last, at_home, stretch2, found.hits.data())
                                          : hits_in(own, static_cast<std::size_t>(runs[r].first),
                                                    static_cast<std::size_t>(runs[r].last), runs[r].shift,
                                                    stretch2, found.hits.data());
            if (pairs.size() < found.count + hits) pairs.resize(2 * (found.count + hits));
            for (std::size_t h = 0; h < hits; ++h) {
                const std::int32_t a = id_[own], b = id_[static_cast<std::size_t>(near[h].place)];
                if (a == b) continue;  // a particle is no neighbour of its own copies
                const int image = home ? image_home : runs[r].image;
                const double sum = radius_[own] + radius_[static_cast<std::size_t>(near[h].place)];
                pairs[found.count++] = {std::min(a, b), std::max(a, b),
                                        a < b ? image : image_count - 1 - image,
                                        gap_section(near[h].d2 / (sum * sum), skin)};
            }
        }
    }
}

/// The bins from x0, as many as a cube is wide.
void NeighbourGrid::search_slice(int x0, const Eigen::Matrix3d& cell, double skin, Found& found) const {
    std::array<Run, 16> runs;
    found.hits.resize(id_.size());
    for (int y0 = 0; y0 < size_[1]; y0 += cube)
        for (int z0 = 0; z0 < size_[2]; z0 += cube)
            for (int x = x0; x < std::min(x0 + cube, size_[0]); ++x)
                for (int y = y0; y < std::min(y0 + cube, size_[1]); ++y)
                    for (int z = z0; z < std::min(z0 + cube, size_[2]); ++z)
                        search_bin(index(x, y, z), runs.data(), collect_runs(x, y, z, cell, runs), skin,
                                   found);
}

std::size_t NeighbourGrid::find_pairs(const Eigen::Matrix3d& cell, double skin, Crew& crew,
                                      std::vector<NearPair>& pairs) {
    const auto slices = static_cast<std::size_t>((size_[0] + cube - 1) / cube);
    found_.resize(std::max(found_.size(), crew.threads() == 1 ? 1 : slices));
    if (crew.threads() == 1) {
        std::swap(found_[0].pairs, pairs);
        found_[0].count = 0;
        for (int x0 = 0; x0 < size_[0]; x0 += cube) search_slice(x0, cell, skin, found_[0]);
        std::swap(found_[0].pairs, pairs);
        return found_[0].count;
    }
    crew.run(slices, [&](std::size_t slice) {
        found_[slice].count = 0;
        search_slice(cube * static_cast<int>(slice), cell, skin, found_[slice]);
    });
    std::size_t count = 0;
    for (std::size_t slice = 0; slice < slices; ++slice) {
        const Found& found = found_[slice];
        if (pairs.size() < count + found.count) pairs.resize(2 * (count + found.count));
        std::copy_n(found.pairs.begin(), found.count, pairs.begin() + static_cast<std::ptrdiff_t>(count));
        count += found.count;
    }
    return count;
}

std::vector<std::int32_t> locality_order(const Packing& packing) {
    const Eigen::Matrix3d inverse = packing.cell.inverse();
    const double bin = 2 * packing.radii.maxCoeff();
    const auto count = static_cast<std::size_t>(packing.radii.size());
    std::vector<std::uint64_t> key(count);
    for (std::size_t p = 0; p < count; ++p) {
        const Eigen::Vector3d f = inverse * packing.centres.col(static_cast<Eigen::Index>(p));
        std::uint64_t outer = 0, inner = 0;
        for (int k = 0; k < 3; ++k) {
            const double thickness = 1.0 / inverse.row(k).norm();
            const auto b = static_cast<std::uint64_t>(
                std::min(1e6, std::floor((f[k] - std::floor(f[k])) * std::max(1.0, thickness / bin))));
            outer = outer << 18 | b / cube;
            inner = inner * cube + b % cube;
        }
        key[p] = outer << 6 | inner;
    }
    std::vector<std::int32_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
    });
    return order;
}

}  // namespace loam::engine
