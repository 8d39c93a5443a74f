// What direct runs at a fit's estimate say of the emulator that it was made with.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "experiments/fit.hpp"

namespace loam::experiments {

/// Outputs `columns` of the runs that succeeded [n x m], transformed.
Eigen::MatrixXd transformed_curves(const std::vector<RunRecord>& runs,
                                   const std::vector<Eigen::Index>& columns,
                                   const std::vector<OutputTransform>& transforms);

struct EmulatorCheck {
    // How far the posterior's mean would move, were the emulator corrected by what the direct runs' mean
    // differs from it: of the parameter that moves most for what is allowed, in standard deviations of its
    // posterior. NaN, as the other numbers, where there was nothing to compare.
    double shift = NAN;
    // Of that shift: half a standard deviation, or up to two where the scatter of the direct runs makes that
    // by chance.
    double limit = NAN;
    Eigen::Index parameter = 0;
    // Of the direct runs' mean curve from the emulator's: rms over what is tolerable and the noise of that
    // mean together, of the worst curve.
    double difference = NAN;

    bool agrees() const { return shift <= limit && difference <= 1; }
};

/// Compares the emulator with `direct`, the transformed curves [n x m] of runs at the fit's estimate. The
/// shift is that of a linear model: posterior covariance times the change of the log likelihood's slope. The
/// posterior of a large specimen can be narrower than the scatter of a few small ones, so every run's own
/// shift is taken, and their standard error is the noise of the mean.
EmulatorCheck check_emulator(const Fit& fit, const TrainedEmulator& trained, const Observation& observation,
                             const Eigen::MatrixXd& direct);

}  // namespace loam::experiments
