// Bins of a periodic cell in fractional coordinates, for the search of neighbours and for an order of the
// particles that keeps neighbours close in memory.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/crew.hpp"
#include "engine/packing.hpp"
#include "engine/state.hpp"

namespace loam::engine {

/// A pair of particles and of a periodic copy: i < j, the copy of j shifted by `image`.
struct NearPair {
    std::int32_t i, j, image, section;  // section: see PairList
};

/// Bins at least as thick as the largest reach; buffers are kept from one filling to the next.
class NeighbourGrid {
  public:
    /// Sorts `count` particles, wrapped into the cell, into bins. Throws std::runtime_error when the cell is
    /// thinner than `reach`.
    void fill(const AlignedVector<ParticleRow>& particles, std::size_t count, const Eigen::Matrix3d& inverse,
              double reach);

    /// All pairs with a gap below skin·(R_i + R_j), in an order that keeps neighbours together and does not
    /// depend on the crew; returns how many were written to the front of `pairs`.
    std::size_t find_pairs(const Eigen::Matrix3d& cell, double skin, Crew& crew,
                           std::vector<NearPair>& pairs);

  private:
    struct Run {  // of bins that are contiguous in memory, under one periodic shift
        std::int32_t first, last, image;
        double shift[3];
    };
    std::int32_t index(int x, int y, int z) const { return (x * size_[1] + y) * size_[2] + z; }
    int collect_runs(int x, int y, int z, const Eigen::Matrix3d& cell, std::array<Run, 16>& runs) const;
    struct Hit {
        std::int32_t place;
        double d2;
    };
    struct Found {  // the first `count` of `pairs`
        std::vector<NearPair> pairs;
        std::size_t count = 0;
        std::vector<Hit> hits;
    };
    void search_slice(int x0, const Eigen::Matrix3d& cell, double skin, Found& found) const;
    void search_bin(std::int32_t bin, const Run* runs, int run_count, double skin, Found& found) const;
    std::size_t hits_in(std::size_t own, std::size_t first, std::size_t last, const double* shift,
                        double stretch2, Hit* out) const;

    std::array<int, 3> size_{};
    std::vector<std::int32_t> start_, cursor_, bin_of_;  // members of bin b are start_[b]..start_[b+1]
    std::vector<std::int32_t> id_;                       // particle of every place, bins one after the other
    std::vector<double> x_, y_, z_, radius_;
    std::vector<Found> found_;  // in every slice of the cell
};

/// The particles by small cubes of space: element k is the particle to be kept at place k.
std::vector<std::int32_t> locality_order(const Packing& packing);

}  // namespace loam::engine
