// Do two parameter sets, each fitted to tests of its own, agree? A test on their posteriors.
#pragma once

#include <Eigen/Core>

#include "experiments/fit.hpp"
#include "experiments/parameter_space.hpp"

namespace loam::experiments {

/// A posterior's mean [d] and covariance [d x d], in the unit cube.
struct Gaussian {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};

/// Of the parameters, the first d columns of the posterior's draws.
Gaussian gaussian_of(const Fit& fit, Eigen::Index d);

struct Agreement {
    double statistic = 0;      // chi-squared distributed where one parameter set made both data
    Eigen::Index degrees = 0;  // directions of parameter space on which both data speak
    double p_value = 1;
    Eigen::VectorXd difference;  // [d] of the sets, b - a, along those directions, without the priors' pull
    Eigen::VectorXd sd;          // [d] of that difference where the sets agree
};

/// Compares two posteriors that share a prior with that precision [d] (zero where it is flat) and mean [d],
/// under the hypothesis that one set made both data.
///
/// A posterior's precision is L + P: what its data and its prior say. Its data alone have the estimate x with
/// L x = (L + P) mean - P m. Where one set made both data, x_b - x_a is normal about zero with the covariance
/// L_a^-1 + L_b^-1. It is taken along the directions that make both L diagonal, and those are left out along
/// which one of the data says less than a tenth of what the prior does. Exact for linear models with normal
/// noise.
Agreement compare_sets(const Gaussian& a, const Gaussian& b, const Eigen::VectorXd& prior_precision,
                       const Eigen::VectorXd& prior_mean);

/// The priors of a space as those two numbers a parameter, in the unit cube.
void prior_as_normal(const ParameterSpace& space, Eigen::VectorXd& precision, Eigen::VectorXd& mean);

}  // namespace loam::experiments
