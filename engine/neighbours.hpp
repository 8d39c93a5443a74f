// The list of neighbour pairs of a periodic packing, rebuilt without losing the history of any contact.
#pragma once

#include <Eigen/Core>

#include "engine/state.hpp"

namespace loam::engine {

/// Wraps all particles into the cell, finds every pair (and periodic copy) whose gap is below `skin`·(R_i +
/// R_j), and carries over bond and shear of the pairs that were in the list and still have a bond. Pairs with
/// an active bond are kept at any distance. `particles` holds `count` real rows and then two dummies. Throws
/// std::runtime_error when the cell has become smaller than two particles, where periodic copies can no
/// longer be told apart.
void rebuild_pairs(PairList& pairs, AlignedVector<ParticleRow>& particles, std::size_t count,
                   const Eigen::Matrix3d& cell, double skin);

}  // namespace loam::engine
