// Slabs of the cell, for several threads on one simulation. Pairs inside a slab share no particle with those
// of another slab, and pairs across one face none with those across another; so the pair list has a part for
// each slab and one for each face, and first the slabs, then the faces may be worked on at once. Forces on a
// particle are thus added in an order that does not depend on the number of threads.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/neighbour_grid.hpp"
#include "engine/state.hpp"

namespace loam::engine {

inline constexpr std::size_t most_slabs = 16;

/// Into how many slabs across its first edge a cell with so many particles is cut: 1 where it is too small
/// for threads to pay. A function of the packing alone, never of the number of threads.
int slab_count(std::size_t particles, const Eigen::Matrix3d& cell, double largest_diameter);

class Slabs {
  public:
    explicit Slabs(int count = 1) : count_(count) {}
    int count() const { return count_; }
    /// Parts of the pair list: slabs, then faces.
    std::size_t parts() const { return count_ == 1 ? 1 : 2 * static_cast<std::size_t>(count_); }

    /// The part of each pair [pairs]. Where slabs have become so thin that a pair reaches beyond the next
    /// one, or a particle has partners across both of its slab's faces, all pairs are put into the first
    /// part.
    void sort_out(const AlignedVector<ParticleRow>& particles, std::size_t count,
                  const Eigen::Matrix3d& inverse, const std::vector<NearPair>& near, std::size_t pairs,
                  std::vector<std::int32_t>& part_of);

  private:
    bool try_to_sort(const std::vector<NearPair>& near, std::size_t pairs,
                     std::vector<std::int32_t>& part_of);

    int count_;
    std::vector<std::int32_t> slab_of_, face_of_;  // of every particle
};

}  // namespace loam::engine
