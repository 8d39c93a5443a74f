/// What every optimiser is given and what it gives back: objective, residuals, box, options, summary,
/// minimum.
///
/// Variables are meant to be scaled to about the unit cube; nothing here knows what they stand for.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <string>

namespace loam::optimizers {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// Value at x [d]; when gradient != nullptr it is filled [d] (it arrives with that size).
/// A value (or gradient) that is not a number marks a point that could not be evaluated: it counts as
/// +infinity. Exceptions leave the optimiser as they were thrown.
using Objective = std::function<double(const Vector& x, Vector* gradient)>;

/// Residuals [m] at x [d]; when jacobian != nullptr it is filled [m x d]. m must be the same at every x.
using Residuals = std::function<void(const Vector& x, Vector& residuals, Matrix* jacobian)>;

/// The box lower <= x <= upper, both [d], finite. lower(i) == upper(i) keeps that variable fixed.
struct Bounds {
    Vector lower, upper;

    /// Throws std::invalid_argument when sizes differ, a bound is not finite or lower > upper.
    void validate() const;
    Eigen::Index size() const { return lower.size(); }
    /// x moved to the nearest point of the box.
    Vector clamp(const Vector& x) const { return x.cwiseMax(lower).cwiseMin(upper); }
};

/// Throws std::invalid_argument when start is not of the bounds' size or not finite.
void validate_start(const Vector& start, const Bounds& bounds);

/// The unit cube in d dimensions.
Bounds unit_cube(Eigen::Index d);

struct Options {
    int max_evaluations = 2000;  ///< calls of the objective (with or without gradient); >= 1, never exceeded
    double relative_tolerance = 1e-8;  ///< on the value and on x (relative to the box); in (0, 1)
    double max_seconds = 0;            ///< wall time; 0: no limit. A limit gives up repeatability
    std::uint64_t seed = 1;            ///< of everything random in the optimiser

    /// Throws std::invalid_argument naming field, value and constraint.
    void validate() const;
};

struct Summary {
    std::string stopped_by = "not run";  ///< the rule that ended the run, in words
    int evaluations = 0;                 ///< calls of the objective
    double seconds = 0;                  ///< wall time
    bool converged = false;              ///< a tolerance was met, rather than a budget spent
};

struct Minimum {
    Vector x;          ///< [d], inside the bounds
    double value = 0;  ///< objective at x, finite
    Summary summary;
};

}  // namespace loam::optimizers
