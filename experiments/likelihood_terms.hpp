// What every comparison of a measured curve with an emulator's is made of: the noise of readings, the misfit
// of the model, and the priors as residuals of a least-squares problem (see fit.hpp).
#pragma once

#include <Eigen/Core>

#include "experiments/fit.hpp"

namespace loam::experiments {

/// What the model cannot follow, as a standard deviation of every reading (strain): a few 1e-4 where it
/// follows well, up to several percent where it does not.
extern const surrogate::Prior misfit_prior;

/// Variance [m] of each reading about the model's curve, on the transformed scale, from measurement and
/// misfit (SI).
Eigen::VectorXd reading_variance(const Observation& observation, const OutputTransform& transform,
                                 double misfit);

/// The priors of the parameters at x [d] as residuals (their squares sum to -2 log density up to a constant)
/// in rows first .. first + d of `out` and, if not nullptr, of `jacobian` [rows x d].
void prior_residuals(const ParameterSpace& space, const Eigen::VectorXd& x, Eigen::Index first,
                     Eigen::VectorXd& out, Eigen::MatrixXd* jacobian);

}  // namespace loam::experiments
