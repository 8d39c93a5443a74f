// Where the runs are made that train a campaign's first emulator: over the whole prior, or in two waves, of
// which the second goes where the first leaves the parameters plausible. Far from what was measured runs are
// of little use, and some are dear: stiff grains take steps by the million.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/campaign.hpp"
#include "experiments/window.hpp"

namespace loam::experiments {

/// What a calibration fits, where several share a campaign's runs.
struct CalibrationTask {
    std::vector<lab_data::TestKind>
        kinds{};              // of the tests that are fitted; empty: all that are not held out
    std::uint64_t place = 0;  // 0..4, of its own runs in the ensemble
    std::string title{};      // goes before what progress says
    bool chooses = true;      // by direct runs among the sets tried, if the emulator never becomes sure
    // Its runs are those of a calibration to all tests: a round of runs about its own posterior, before any
    // direct runs, is enough; further ones only where the emulator is not sure then, or is contradicted by
    // direct runs.
    bool follows = false;
    // Of the direct runs, where not fresh ones: sets that are compared are compared on the same packings. No
    // emulator may have been trained on them.
    std::vector<std::uint64_t> packings{};
};

/// Probabilities [n x d] as coordinates of the unit cube: by the priors' quantiles, within the window.
Eigen::MatrixXd from_probabilities(const ParameterSpace& space, const Window& window,
                                   const Eigen::MatrixXd& u);

/// Adds runs at the design over the whole prior, and further packings at some of its points: for emulators
/// that serve many measurements.
std::vector<RunRecord> training_runs(Campaign& campaign);

/// How many of `runs` in two waves are made in the first; all where the rest would be too few to matter.
int first_wave(int runs, int parameters);

/// The same number of runs, for the campaign's own measurements: a first wave over `first` (empty: the whole
/// prior), a second where that leaves the parameters of any of the tasks plausible; without
/// calibration.narrowing those of training_runs. `known`: further runs that the first emulator may learn
/// from; they are not among the runs returned.
std::vector<RunRecord> narrowing_runs(Campaign& campaign, std::span<const CalibrationTask> tasks,
                                      const std::optional<Window>& first = {},
                                      const std::vector<RunRecord>& known = {});

/// A run of that place in the ensemble, from which its packing and all its randomness follow.
RunSpec training_spec(const Campaign& campaign, std::uint64_t index, const char* purpose,
                      const Eigen::VectorXd& parameters);

}  // namespace loam::experiments
