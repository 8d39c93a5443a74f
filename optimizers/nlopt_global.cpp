// The global searches of NLopt.
#include <cmath>

#include "optimizers/minima_seen.hpp"
#include "optimizers/nlopt_driver.hpp"
#include "optimizers/optimisers.hpp"
#include "optimizers/random.hpp"

namespace loam::optimizers {

// Rectangles far from the best point are divided long before those near it gain again, so that nothing but
// the size of all that are left says that the search is done: in more than one variable it spends its budget.
Minimum minimise_direct_l(const Objective& objective, const Bounds& bounds, const Vector& start,
                          const Options& options) {
    GuardedObjective guarded(objective, bounds, start, options);
    const auto [reason, converged] =
        search_with_nlopt(NLOPT_GN_DIRECT_L, StopRule::x, guarded, guarded.start(), options.seed);
    return guarded.minimum(reason, converged);
}

// One population often settles in a broad basin beside the best one (in two of three runs on Hartmann's
// function of six variables), so that new populations follow until no minimum is likely to be unseen.
Minimum minimise_crs2(const Objective& objective, const Bounds& bounds, const Vector& start,
                      const Options& options) {
    GuardedObjective guarded(objective, bounds, start, options);
    MinimaSeen minima;
    for (std::uint64_t run = 0; !guarded.stopped() && !minima.probably_complete(); ++run) {
        search_with_nlopt(NLOPT_GN_CRS2_LM, StopRule::stagnation, guarded, guarded.start(),
                          hash(options.seed) + run);
        if (guarded.box().size() == 0) break;
        if (std::isfinite(guarded.search_best())) minima.add(guarded.search_best());
    }
    return guarded.minimum(MinimaSeen::reason, true);
}

}  // namespace loam::optimizers
