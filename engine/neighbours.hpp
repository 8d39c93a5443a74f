// The list of neighbour pairs of a periodic packing, rebuilt without losing the history of any contact.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/neighbour_grid.hpp"
#include "engine/slabs.hpp"
#include "engine/state.hpp"

namespace loam::engine {

/// What a rebuild works on, kept so that the next one allocates nothing.
struct RebuildBuffers {
    struct Bond {  // a contact of the old list, with its image as it is after wrapping
        std::int32_t j, image_code;
        std::size_t at;  // place in the old list
        bool found;
    };
    NeighbourGrid grid;
    std::vector<Eigen::Vector3i> moved;  // by how many cells every particle was wrapped
    std::vector<NearPair> near;
    std::vector<std::size_t> bond_start;  // contacts of particle i are bonds[bond_start[i]..bond_start[i+1]]
    std::vector<Bond> bonds;
    std::vector<std::size_t> bond_of, order, next_place;
    std::vector<std::int32_t> part_of;
    PairList old;
};

/// Where the row of a particle starts (bytes).
constexpr std::uint32_t row_offset(std::int32_t particle) {
    return static_cast<std::uint32_t>(particle) * static_cast<std::uint32_t>(row_bytes);
}

/// Fills a stretch of the list with the two dummies after the `count` particles, which never touch.
void fill_with_dummies(PairList& pairs, std::size_t first, std::size_t last, std::size_t count);

/// Wraps all particles into the cell, finds every pair (and periodic copy) whose gap is below `skin`·(R_i +
/// R_j), and carries over bond and shear of the pairs that were in the list and still have a bond. Pairs with
/// an active bond are kept at any distance. `particles` holds `count` real rows and then two dummies. Throws
/// std::runtime_error when the cell has become smaller than two particles, where periodic copies can no
/// longer be told apart.
void rebuild_pairs(PairList& pairs, RebuildBuffers& buffers, AlignedVector<ParticleRow>& particles,
                   std::size_t count, const Eigen::Matrix3d& cell, double skin, Slabs& slabs, Crew& crew);

}  // namespace loam::engine
