/// Bounded nonlinear least squares with analytic Jacobians: Ceres Solver's Levenberg-Marquardt, dense, silent
/// and on one thread.
///
/// A Gaussian prior is one more residual, (x - mean) / sd. With every residual divided by its standard
/// deviation the value is the negative log density, and the covariance is that of x in the Gaussian
/// approximation.
#pragma once

#include <optional>

#include "optimizers/problem.hpp"

namespace loam::optimizers {

struct LeastSquares {
    Minimum minimum;   ///< value: half the sum of squared residuals
    Vector residuals;  ///< [m] at the minimum
    Matrix jacobian;   ///< [m x d] at the minimum
};

/// Minimises |r(x)|^2 / 2 over `bounds` from `start` [d] (moved into the box).
/// Each call of `residuals`, with or without Jacobian, counts as an evaluation. Residuals or Jacobians that
/// are not finite mark a point that could not be evaluated; the step is then shortened. `options.seed` has no
/// effect. Throws std::invalid_argument for unsound bounds, options, start or a changing number of residuals;
/// std::runtime_error when the residuals are not finite at the start; whatever `residuals` throws.
/// Source: Levenberg 1944; Marquardt 1963; Agarwal, Mierle et al., Ceres Solver 2.1, trust region with
/// bounds.
LeastSquares minimise_least_squares(const Residuals& residuals, const Bounds& bounds, const Vector& start,
                                    const Options& options = {});

/// Inverse of J^T J [d x d], for J [m x d] of residuals in units of their standard deviations; none when J
/// has not full column rank (relative tolerance 1e-10 on the singular values of J with its columns scaled to
/// length one). For residuals of unknown common variance multiply by |r|^2 / (m - d).
std::optional<Matrix> covariance(const Matrix& jacobian);

}  // namespace loam::optimizers
