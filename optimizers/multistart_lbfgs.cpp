// L-BFGS from many starts, until no minimum is likely to be unseen.
//
// The first search begins at the caller's start. Each further one begins at the best of a few points of a
// low-discrepancy sequence (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": additive
// recurrence on the powers of the generalised golden ratio), shifted at random by the seed (Cranley &
// Patterson 1976).
#include <cmath>

#include "optimizers/minima_seen.hpp"
#include "optimizers/nlopt_driver.hpp"
#include "optimizers/optimisers.hpp"
#include "optimizers/random.hpp"

namespace loam::optimizers {

namespace {

constexpr int points_per_search =
    5;  // of which the best is searched from; a search costs some five times as many

class ShiftedSequence {
  public:
    ShiftedSequence(Eigen::Index k, std::uint64_t seed) : step_(k), point_(k) {
        Random random(seed);
        double ratio = 2;  // the root of ratio^(k+1) = ratio + 1
        for (int i = 0; i < 64; ++i) ratio = std::pow(1 + ratio, 1.0 / (static_cast<double>(k) + 1));
        for (Eigen::Index j = 0; j < k; ++j) {
            step_(j) = std::pow(1 / ratio, static_cast<double>(j) + 1);
            point_(j) = random.uniform();
        }
    }
    const Vector& next() {
        point_ += step_;
        point_ = point_.array() - point_.array().floor();
        return point_;
    }

  private:
    Vector step_, point_;
};

/// The best of the next few points; any of them when none could be evaluated.
Vector best_of_next(ShiftedSequence& sequence, GuardedObjective& guarded) {
    Vector best;
    double lowest = 0;
    for (int i = 0; i < points_per_search && !guarded.stopped(); ++i) {
        const Vector& candidate = sequence.next();
        const double value = guarded.evaluate(candidate, nullptr);
        if (i > 0 && value >= lowest) continue;
        lowest = value;
        best = candidate;
    }
    return best;
}

}  // namespace

Minimum minimise_multistart_lbfgs(const Objective& objective, const Bounds& bounds, const Vector& start,
                                  const Options& options) {
    GuardedObjective guarded(objective, bounds, start, options);
    ShiftedSequence sequence(guarded.box().size(), options.seed);
    MinimaSeen minima;
    Vector from = guarded.start();
    while (!guarded.stopped()) {
        search_with_nlopt(NLOPT_LD_LBFGS, StopRule::value_or_x, guarded, from, options.seed);
        if (std::isfinite(guarded.search_best())) minima.add(guarded.search_best());
        if (guarded.box().size() == 0 || minima.probably_complete()) break;
        from = best_of_next(sequence, guarded);
    }
    return guarded.minimum(MinimaSeen::reason, true);
}

}  // namespace loam::optimizers
