// Fits one sample through the emulator that it shares: weighted draws of the posterior, the most probable
// set, in a fraction of a second. The likelihood is that of fit.hpp.
//
// The posterior allows for the scatter of a measured specimen that is a small packing itself. The estimate
// does not: it is the most probable set whose mean curve over packings follows the measured curve, for that
// is what a simulation with it is to reproduce, and what the direct runs are compared with.
#pragma once

#include <cstdint>

#include "experiments/bulk/group_emulator.hpp"
#include "optimizers/importance.hpp"

namespace loam::experiments {

struct SampleFit {
    Eigen::VectorXd estimate;   // [d] most probable coordinates in the unit cube
    double misfit = 0;          // SI, at the estimate
    Eigen::MatrixXd quantiles;  // [d x 3] 5, 50 and 95 % of the posterior
    double effective = 0;       // number of independent draws that they rest on
    double emulator_share = 0;  // of the residuals' variance at the estimate
    Eigen::VectorXd predicted;  // [m] the emulator's curve at the estimate, SI
};

/// Deterministic under the seed. Throws std::runtime_error where no draw has a density.
SampleFit fit_sample(const BulkSample& sample, const GroupEmulator& group, const ParameterSpace& space,
                     const Settings& settings, std::uint64_t seed);

/// The emulator's curve [m] at coordinates x [d], as the mean of direct runs would show it, SI.
Eigen::VectorXd predicted_curve(const BulkSample& sample, const GroupEmulator& group,
                                const ParameterSpace& space, const Eigen::VectorXd& x);

/// `count` points [count x d] where the sample's posterior lies, roughly: where further runs teach most.
/// Throws std::runtime_error where no draw has a density.
Eigen::MatrixXd likely_points(const BulkSample& sample, const GroupEmulator& group,
                              const ParameterSpace& space, Eigen::Index count, std::uint64_t seed);

}  // namespace loam::experiments
