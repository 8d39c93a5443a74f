// Whether a fit's emulator knows enough: by the fit itself, and by direct runs at its estimate.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "experiments/fit.hpp"

namespace loam::experiments {

inline constexpr double tolerable_share = 0.25;  // of the residuals' variance that the emulator may cause

/// The first parameter whose estimate lies outside the central part of the posterior; -1 if none does. The
/// two differ where the emulator is much less sure in one place than in the other.
Eigen::Index outside_posterior(const Fit& fit, double central = 0.99);

inline constexpr double reported_interval = 0.9;  // central part of the posterior

/// Where the emulator is not sure, and the intervals do not hold the estimate, they tell where it knows
/// least, not what was measured: Fit::plausible becomes the posterior. Returns the first parameter for which
/// it was so, or -1.
Eigen::Index bring_to_estimate(Fit& fit);

/// Whether the posterior is about the estimate, and hardly made of what the emulator does not know.
bool is_sure(const Fit& fit);

/// Coordinates [n x d], n at most `whole`, at which runs of a round are worth making: draws of the posterior,
/// of Fit::near and of Fit::plausible, the k-th by the random number of (seed, first + k). A posterior that
/// is mostly the emulator's ignorance must be searched, but its runs say little of the estimate: two thirds
/// of them are made near the estimate and where the parameters are plausible by what the emulator does know.
/// Where the estimate lies outside the posterior, a few runs in the latter end that, and such places, far
/// from what was measured, can be dear (a direct shear posterior at 4e9 Pa, for a soil of 9e7: 24 s a run). A
/// task that `follows` makes no direct runs until it is sure, and can take them two by two.
Eigen::MatrixXd sets_to_add(const Fit& fit, int whole, bool follows, std::uint64_t seed, std::uint64_t first);

/// Outputs `columns` of the runs that succeeded [n x m], transformed.
Eigen::MatrixXd transformed_curves(const std::vector<RunRecord>& runs,
                                   const std::vector<Eigen::Index>& columns,
                                   const std::vector<OutputTransform>& transforms);

/// Places of the sets tried between which direct runs do not decide, three at the most, the foremost first:
/// of log densities [k] (densities_by_runs), k > 0, those not further behind the greatest than 100:1.
std::vector<std::size_t> in_question(const std::vector<double>& densities);

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
