// The local searches of NLopt, each begun again at its best point until that gains nothing: a line search
// that failed or a tolerance met by chance (two equal values in a row) is thereby told from a minimum at the
// price of a few calls.
#include <cmath>

#include "optimizers/nlopt_driver.hpp"
#include "optimizers/optimisers.hpp"

namespace loam::optimizers {

namespace {

Minimum minimise_locally(nlopt_algorithm algorithm, const Objective& objective, const Bounds& bounds,
                         const Vector& start, const Options& options) {
    GuardedObjective guarded(objective, bounds, start, options);
    Vector from = guarded.start();
    for (double last = std::numeric_limits<double>::infinity();;) {
        NloptOutcome outcome =
            search_with_nlopt(algorithm, StopRule::value_or_x, guarded, from, options.seed);
        if (guarded.stopped() || !guarded.gained_since(last) || guarded.box().size() == 0) {
            // A search that cannot improve on a converged one has found the same minimum again.
            return guarded.minimum(outcome.reason, outcome.converged || std::isfinite(last));
        }
        last = guarded.search_best();
        from = guarded.best_z();
    }
}

}  // namespace

Minimum minimise_lbfgs(const Objective& objective, const Bounds& bounds, const Vector& start,
                       const Options& options) {
    return minimise_locally(NLOPT_LD_LBFGS, objective, bounds, start, options);
}

Minimum minimise_slsqp(const Objective& objective, const Bounds& bounds, const Vector& start,
                       const Options& options) {
    return minimise_locally(NLOPT_LD_SLSQP, objective, bounds, start, options);
}

Minimum minimise_sbplx(const Objective& objective, const Bounds& bounds, const Vector& start,
                       const Options& options) {
    return minimise_locally(NLOPT_LN_SBPLX, objective, bounds, start, options);
}

}  // namespace loam::optimizers
