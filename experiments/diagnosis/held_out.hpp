// How well a model predicts curves that it was not fitted to: each group of outputs in turn is left out, the
// parameters are fitted to the others, and the group is predicted with the uncertainty of noise and
// parameters.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/diagnosis/linear_model.hpp"

namespace loam::experiments {

/// A model about to be fitted: may be nonlinear.
struct FittedModel {
    Eigen::VectorXd measured;              // [m]
    Eigen::MatrixXd noise;                 // [m x m]
    Eigen::VectorXd prior_mean, prior_sd;  // [d] coordinates in the unit cube
    /// Curve [m] at x [d] and, if asked for, its jacobian [m x d].
    std::function<Eigen::VectorXd(const Eigen::VectorXd& x, Eigen::MatrixXd* jacobian)> curve;
};

/// Outputs that are left out together.
struct HeldOutGroup {
    std::string name;
    std::vector<Eigen::Index> outputs;
};

struct HeldOutScore {
    std::string name;
    double log_score = 0;  // of the group's measured values under the prediction
    double squares = 0;    // of the errors over the variances of the noise alone, summed
    Eigen::Index outputs = 0;
};

/// Most probable point [d] given the outputs listed (all: empty list), from `start` and from the priors'
/// mean.
Eigen::VectorXd most_probable(const FittedModel& model, const std::vector<Eigen::Index>& outputs,
                              const Eigen::VectorXd& start);

/// The model made linear at x [d].
LinearModel linearised(const FittedModel& model, const Eigen::VectorXd& x);

/// Each group predicted from all other outputs.
std::vector<HeldOutScore> predict_held_out(const FittedModel& model, const std::vector<HeldOutGroup>& groups,
                                           const Eigen::VectorXd& start);

/// Root of the mean square of all groups' errors over their noise: 1 where noise alone is left.
double error_over_noise(const std::vector<HeldOutScore>& scores);

/// What the errors are beyond noise, in units of noise: root of the mean square less 1; 0 where noise alone
/// is left.
double gap(const std::vector<HeldOutScore>& scores);

/// By which share a gap has become smaller; 0 where there was none and is none.
double shrink_of(double before, double after);

/// 5 and 95 % quantiles of the gaps and of the shrink, over groups drawn with replacement.
struct GapInterval {
    double before_low = 0, before_high = 0, after_low = 0, after_high = 0, shrink_low = 0, shrink_high = 0;
};
GapInterval gap_interval(const std::vector<HeldOutScore>& before, const std::vector<HeldOutScore>& after,
                         std::uint64_t seed);

}  // namespace loam::experiments
