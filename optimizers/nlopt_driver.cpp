#include "optimizers/nlopt_driver.hpp"

#include <memory>
#include <stdexcept>

#include "optimizers/random.hpp"

namespace loam::optimizers {

namespace {

struct Search {
    GuardedObjective& guarded;
    nlopt_opt handle;
    StopRule rule;

    bool stagnated() const { return rule == StopRule::stagnation && guarded.stagnated(); }
};

/// NLopt is C: nothing may be thrown through it, so a stop is asked for and the reason waits in the guard.
double callback(unsigned n, const double* z, double* gradient, void* data) {
    auto& search = *static_cast<Search*>(data);
    const double value = search.guarded.evaluate(Eigen::Map<const Vector>(z, n), gradient);
    if (search.guarded.stopped() || search.stagnated()) nlopt_force_stop(search.handle);
    return value;
}

NloptOutcome outcome(nlopt_result result, const char* message) {
    switch (result) {
        case NLOPT_SUCCESS:
            return {"gradient tolerance met", true};
        case NLOPT_FTOL_REACHED:
            return {"relative tolerance on the value met", true};
        case NLOPT_XTOL_REACHED:
            return {"relative tolerance on x met", true};
        case NLOPT_ROUNDOFF_LIMITED:
            return {"rounding errors limit further progress", true};
        case NLOPT_FAILURE:
            return {"the line search found no lower value", false};
        case NLOPT_FORCED_STOP:
        case NLOPT_MAXEVAL_REACHED:
            return {"the budget is spent", false};
        case NLOPT_OUT_OF_MEMORY:
            throw std::bad_alloc();
        default:
            throw std::logic_error("optimizers: NLopt refused the search: " +
                                   std::string(message ? message : nlopt_result_to_string(result)));
    }
}

}  // namespace

NloptOutcome search_with_nlopt(nlopt_algorithm algorithm, StopRule rule, GuardedObjective& guarded,
                               const Vector& z, std::uint64_t seed) {
    guarded.begin_search();
    if (guarded.box().size() == 0) {
        guarded.evaluate(z, nullptr);
        return {"all variables are fixed", true};
    }
    const auto k = static_cast<unsigned>(guarded.box().size());
    const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> handle(nlopt_create(algorithm, k), nlopt_destroy);
    if (!handle) throw std::bad_alloc();
    Search search{guarded, handle.get(), rule};
    nlopt_set_lower_bounds1(handle.get(), 0.0);
    nlopt_set_upper_bounds1(handle.get(), 1.0);
    nlopt_set_min_objective(handle.get(), callback, &search);
    const double tolerance = guarded.options().relative_tolerance;
    if (rule == StopRule::value_or_x) nlopt_set_ftol_rel(handle.get(), tolerance);
    if (rule != StopRule::stagnation) nlopt_set_xtol_abs1(handle.get(), tolerance);
    nlopt_set_maxeval(handle.get(), guarded.options().max_evaluations);
    nlopt_srand(static_cast<unsigned long>(hash(seed)));
    Vector point = z;
    double value = 0;
    const nlopt_result result = nlopt_optimize(handle.get(), point.data(), &value);
    if (search.stagnated() && !guarded.stopped()) {
        return {"the last third of the evaluations gained less than the tolerance", true};
    }
    return outcome(result, nlopt_get_errmsg(handle.get()));
}

}  // namespace loam::optimizers
