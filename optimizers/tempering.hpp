/// The warm-up of the posterior sampler. Inside this library only.
#pragma once

#include <functional>
#include <vector>

#include "optimizers/posterior_kernel.hpp"

namespace loam::optimizers {

struct WarmUp {
    std::vector<ChainState> particles;  ///< about draws from the density
    Shares shares;                      ///< of the moves, as they paid in the end
};

/// Carries `size` particles from the uniform distribution on the box to the density, through density^temper
/// with temper rising from 0 to 1: sequential Monte Carlo (Del Moral, Doucet & Jasra 2006, J. R. Stat. Soc. B
/// 68, 411-436). Each step of the temper halves the effective number of particles; they are resampled and
/// moved by a kernel learnt from them. A mode thereby keeps its share of the particles, however narrow it is
/// Once `half_spent()` holds, what is left of the way is done in one step; it is asked between sweeps of all
/// particles. Throws std::runtime_error when too few random points have a density to learn from.
WarmUp warm_up(CubeTarget& target, int size, const std::function<bool()>& half_spent, Random& random);

}  // namespace loam::optimizers
