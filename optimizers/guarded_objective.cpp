#include "optimizers/guarded_objective.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace loam::optimizers {

namespace {

double seconds_since(std::chrono::steady_clock::time_point began) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

const Bounds& validated(const Bounds& bounds, const Options& options) {
    bounds.validate();
    options.validate();
    return bounds;
}

}  // namespace

GuardedObjective::GuardedObjective(const Objective& objective, const Bounds& bounds, const Vector& start,
                                   const Options& options)
    : objective_(objective), options_(options), box_(validated(bounds, options)) {
    validate_start(start, bounds);
    start_ = box_.to_z(start);
}

double GuardedObjective::barrier() const {
    // A finite step, of the size of what was seen: interpolating line searches and quadratic models survive
    // it, an infinity would turn their next point into NaN.
    if (!std::isfinite(worst_)) return 1.0;
    return worst_ + std::max({worst_ - best_, std::abs(worst_) * 1e-3, 1e-3});
}

double GuardedObjective::call(const Vector& x, Vector* gradient) {
    // An objective that leaves its gradient unfilled must not pass for one with a flat spot.
    if (gradient) gradient->setConstant(x.size(), std::numeric_limits<double>::quiet_NaN());
    const double value = objective_(x, gradient);
    if (!gradient) return value;
    for (const Eigen::Index i : box_.free()) {
        if (gradient->size() != x.size() || !std::isfinite((*gradient)(i))) {
            return std::numeric_limits<double>::quiet_NaN();
        }
    }
    return value;
}

double GuardedObjective::evaluate(const Vector& z, double* gradient) noexcept {
    if (gradient) std::fill_n(gradient, box_.size(), 0.0);
    if (stopped() || !z.allFinite()) return barrier();
    try {
        Vector slope;
        const Vector x = box_.to_x(z);
        ++evaluations_;
        const double value = call(x, gradient ? &slope : nullptr);
        check_budget();
        if (!std::isfinite(value)) return barrier();
        if (gradient) {
            for (Eigen::Index j = 0; j < box_.size(); ++j) {
                gradient[j] = slope(box_.free()[static_cast<std::size_t>(j)]) * box_.width(j);
            }
        }
        remember(x, value);
        return value;
    } catch (...) {
        error_ = std::current_exception();
        return barrier();
    }
}

void GuardedObjective::remember(const Vector& x, double value) {
    worst_ = std::max(worst_, value);
    if (value < best_) {
        best_ = value;
        best_x_ = x;
    }
    search_best_ = std::min(search_best_, value);
    if (gained_since(search_reference_)) {
        search_reference_ = search_best_;
        last_gain_ = evaluations_;
    }
}

bool GuardedObjective::gained_since(double before) const {
    const double tolerance = options_.relative_tolerance;
    return before - search_best_ > tolerance * (std::abs(search_best_) + tolerance * (worst_ - best_));
}

void GuardedObjective::begin_search() {
    search_best_ = search_reference_ = std::numeric_limits<double>::infinity();
    search_began_ = last_gain_ = evaluations_;
}

bool GuardedObjective::stagnated() const {
    const int spent = evaluations_ - search_began_;
    return spent >= 100 * (box_.size() + 1) && evaluations_ - last_gain_ > spent / 3;
}

void GuardedObjective::check_budget() {
    if (evaluations_ >= options_.max_evaluations) budget_spent_ = "max_evaluations";
    if (options_.max_seconds > 0 && seconds_since(began_) >= options_.max_seconds)
        budget_spent_ = "max_seconds";
}

Minimum GuardedObjective::minimum(const std::string& reason, bool converged) const {
    if (error_) std::rethrow_exception(error_);
    if (!std::isfinite(best_)) {
        throw std::runtime_error(
            "optimizers: no minimum, because the objective (or its gradient) was finite at none of the " +
            std::to_string(evaluations_) + " points tried");
    }
    Minimum result;
    result.x = best_x_;
    result.value = best_;
    result.summary.evaluations = evaluations_;
    result.summary.seconds = seconds_since(began_);
    result.summary.converged = converged && budget_spent_.empty();
    result.summary.stopped_by = budget_spent_.empty() ? reason : budget_spent_ + " reached";
    return result;
}

}  // namespace loam::optimizers
