// One model in the eyes of the diagnosis: calibrated to all tests together, refined with the noise that is
// known and no allowance for what the model cannot follow, confirmed by direct runs on fresh packings, and
// made linear there.
#pragma once

#include <memory>

#include "experiments/calibration.hpp"
#include "experiments/diagnosis/held_out.hpp"
#include "experiments/diagnosis/regions.hpp"
#include "experiments/output/log.hpp"

namespace loam::experiments {

/// Stays where it is made: `fitted` refers to its other members.
struct StudiedModel {
    StudiedModel(const Settings& settings, const lab_data::Sample& sample,
                 const std::filesystem::path& folder, RunLog* log)
        : campaign(settings, sample, folder, log) {}
    StudiedModel(const StudiedModel&) = delete;
    StudiedModel& operator=(const StudiedModel&) = delete;

    Campaign campaign;
    Calibration calibration;
    Observation observation;
    Eigen::VectorXd estimate;       // [d] in the unit cube, of `fitted`
    std::vector<RunRecord> direct;  // at the estimate, on packings that no emulator was trained on
    Eigen::VectorXd simulated;      // [outputs] their mean, SI
    FittedModel fitted;             // emulator, moved to agree with the direct runs at the estimate
    LinearModel linear;             // of it at the estimate

    const Settings& settings() const { return campaign.settings(); }
};

/// Calibrates and studies a model in `folder` (made if it is not there). `known`: runs of a model that this
/// one holds, with this one's parameters. `first`: where this one's first runs go (narrowing_runs). Throws
/// what calibrate() throws.
std::unique_ptr<StudiedModel> study_model(const Settings& settings, const lab_data::Sample& sample,
                                          const std::filesystem::path& folder, RunLog* log,
                                          const std::vector<RunRecord>& known = {},
                                          const std::optional<Window>& first = {});

/// Covariance [m x m] of measured minus the mean of `direct_runs` direct runs, on the transformed scale at x
/// [d]: measurement, packing noise of the specimen and of the direct runs, and the tolerance of
/// thresholds.hpp. What the model cannot follow is left out: that is what is looked for.
Eigen::MatrixXd noise_of_comparison(const StudiedModel& model, const Eigen::VectorXd& x, double direct_runs);

/// The regions of all fitted curves, declared from the model's direct runs.
std::vector<Region> regions_of(const StudiedModel& model);

/// The outputs of each fitted test, named by its file.
std::vector<HeldOutGroup> tests_to_hold_out(const StudiedModel& model);

/// The outputs of each kind of test that is fitted, named by the kind.
std::vector<HeldOutGroup> tests_by_kind(const StudiedModel& model);

/// Outputs of the fitted tests, on the transformed scale.
Eigen::VectorXd transformed(const StudiedModel& model, const Eigen::VectorXd& outputs);

}  // namespace loam::experiments
