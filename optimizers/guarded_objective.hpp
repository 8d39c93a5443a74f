/// The objective as an optimiser from a C library may safely call it: on the scaled box, within its budget,
/// never throwing, never answering with anything but a finite number, and remembering the best point it has
/// seen.
///
/// The memory matters: the minimum handed back is the best point that was truly evaluated, whatever the
/// library believes it found, and the budget is exact, because calls beyond it are answered without
/// evaluation.
#pragma once

#include <chrono>
#include <exception>
#include <limits>
#include <string>

#include "optimizers/problem.hpp"
#include "optimizers/scaled_box.hpp"

namespace loam::optimizers {

class GuardedObjective {
  public:
    /// Validates bounds, options and start (finite, size d; it is moved into the box), else
    /// std::invalid_argument.
    GuardedObjective(const Objective& objective, const Bounds& bounds, const Vector& start,
                     const Options& options);

    const ScaledBox& box() const { return box_; }
    const Options& options() const { return options_; }
    /// The start on the scaled box [k].
    const Vector& start() const { return start_; }

    /// Value at z [k]; `gradient` (or nullptr) is filled [k]. Where the objective gives no finite number, or
    /// the call comes after stopped(), the answer is a barrier above every value seen, with a gradient of
    /// zero.
    double evaluate(const Vector& z, double* gradient) noexcept;

    /// An exception was caught, or the budget of evaluations or time is spent.
    bool stopped() const { return error_ != nullptr || !budget_spent_.empty(); }

    /// A search within the run starts: search_best() and stagnated() forget what came before.
    void begin_search();
    /// Best point of the run on the scaled box [k]; there must have been a finite value.
    Vector best_z() const { return box_.to_z(best_x_); }
    /// Best value since begin_search(); +infinity if none was finite.
    double search_best() const { return search_best_; }
    /// The best value fell from `before` by more than the tolerance, relative to that value; a minimum of
    /// value 0, where no relative gain is ever small, is reached within the tolerance's square of the range
    /// of values seen.
    bool gained_since(double before) const;
    /// The last third of the search's evaluations (100 (k + 1) or more) lowered its best by no more than the
    /// tolerance. Global searches that improve by chance need it: two equal values in a row say nothing
    /// there.
    bool stagnated() const;
    /// The best point seen. Rethrows what the objective threw; std::runtime_error if no value was finite.
    /// `reason` and `converged` are the optimiser's own account, used unless a budget ended the run.
    Minimum minimum(const std::string& reason, bool converged) const;

  private:
    double barrier() const;
    double call(const Vector& x, Vector* gradient);
    void check_budget();
    void remember(const Vector& x, double value);

    const Objective& objective_;
    Options options_;
    ScaledBox box_;
    Vector start_, best_x_;
    double best_ = std::numeric_limits<double>::infinity();
    double search_best_ = std::numeric_limits<double>::infinity();
    double search_reference_ =
        std::numeric_limits<double>::infinity();  ///< the best at the last gain that counted
    int search_began_ = 0, last_gain_ = 0;        ///< in evaluations
    double worst_ = -std::numeric_limits<double>::infinity();
    int evaluations_ = 0;
    std::string budget_spent_;
    std::exception_ptr error_;
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

}  // namespace loam::optimizers
