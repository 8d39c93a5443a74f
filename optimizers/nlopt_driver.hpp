/// One search by an algorithm of NLopt (Johnson, S. G., The NLopt nonlinear-optimization package) on a
/// guarded objective. Inside this library only: the header brings in nlopt.h.
#pragma once

#include <nlopt.h>

#include <string>

#include "optimizers/guarded_objective.hpp"

namespace loam::optimizers {

struct NloptOutcome {
    std::string reason;      ///< why NLopt stopped, in words
    bool converged = false;  ///< by a tolerance
};

/// When a search ends before its budget.
enum class StopRule {
    value_or_x,  ///< NLopt's own: the last step was small in value or in x
    x,           ///< in x alone
    stagnation,  ///< GuardedObjective::stagnated()
};

/// Searches from z [k] on the scaled box. What it finds is kept in `guarded`, where a new search is begun.
/// With all variables fixed (k = 0) the single point is evaluated and the search has converged.
///
/// NLopt draws from one generator a thread (its state is thread-local). It is seeded here, before every
/// search, so a search depends on `seed` alone, whatever ran before it or runs beside it in another thread.
NloptOutcome search_with_nlopt(nlopt_algorithm algorithm, StopRule rule, GuardedObjective& guarded,
                               const Vector& z, std::uint64_t seed);

}  // namespace loam::optimizers
