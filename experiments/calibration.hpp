// The calibration loop: design -> runs -> emulator -> fit -> direct runs at the estimate on fresh packings;
// where they say that the emulator's error would move the posterior, or is more than a laboratory would not
// notice, or the emulator is a large part of the uncertainty, or estimate and posterior lie apart, runs are
// added where the posterior lies, and the loop goes round; it does so once in any case.
// The direct runs of a round that is over train the next emulator; the last round's never do. If the emulator
// has not become sure when the rounds end, direct runs choose among the estimates tried, of the foremost
// twice as many, and others confirm the one that is chosen.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/campaign.hpp"
#include "experiments/emulator_check.hpp"
#include "experiments/fit.hpp"
#include "experiments/training_design.hpp"

namespace loam::experiments {

struct CalibrationRound {
    Eigen::Index runs = 0;      // that trained the emulator
    double emulator_share = 0;  // of the variance of the residuals, mean over the posterior
    EmulatorCheck check{};
    std::string text;
};

struct Calibration {
    std::optional<TrainedEmulator> trained;
    Fit fit;
    std::vector<Eigen::Index> columns;  // outputs that were fitted
    std::vector<CalibrationRound> rounds;
    std::vector<RunRecord> confirmation;  // direct runs at the estimate on packings that no emulator saw
    Eigen::VectorXd simulated;            // [outputs] their mean, SI
    Eigen::VectorXd replicate_sd;         // [outputs] their scatter, SI
    std::string stopped_by;
    std::vector<std::string> warnings;
};

/// `count` direct runs at `parameters` (SI) on packings that no emulator is trained on; `round` tells their
/// packings from other rounds', of which the first are `packings` where given.
std::vector<RunRecord> direct_runs(Campaign& campaign, const Eigen::VectorXd& parameters, std::uint64_t round,
                                   int count, const std::string& title = {},
                                   const std::vector<std::uint64_t>& packings = {});

/// Runs the whole loop. `runs` are those to train on; what the loop adds is appended to them. Throws
/// Interrupted, and std::runtime_error where too many runs fail.
Calibration calibrate(Campaign& campaign, std::vector<RunRecord>& runs, const CalibrationTask& task = {});
/// The same, from the campaign's own training runs.
Calibration calibrate(Campaign& campaign);

/// Mean of the successful runs' outputs [m]; throws std::runtime_error with the first reason if none
/// succeeded.
Eigen::VectorXd mean_outputs(const std::vector<RunRecord>& runs);
Eigen::VectorXd sd_outputs(const std::vector<RunRecord>& runs);

}  // namespace loam::experiments
