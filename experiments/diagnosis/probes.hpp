// Direct runs of each effect at the calibrated point, on the packings of the base model's direct runs.
#pragma once

#include <stdexcept>

#include "experiments/diagnosis/search.hpp"

namespace loam::experiments {

/// The settings of the base model with the effect, for an ensemble of its own.
Settings settings_with(const Settings& base, const ModelEffect& effect);

/// The folder of that ensemble's store.
std::filesystem::path folder_of(const std::filesystem::path& folder, const ModelEffect& effect);

/// The prior of the effect's strength, or nullptr where it has none.
const surrogate::Prior* prior_of_strength(const ModelEffect& effect, const ParameterSpace& space);

/// Too many of the runs with an effect failed for its fingerprint.
struct TooFewRuns : std::runtime_error {
    TooFewRuns(const std::string& what, std::size_t runs, std::size_t failed)
        : std::runtime_error(what), runs(runs), failed(failed) {}
    std::size_t runs, failed;
};

/// What an effect of that strength (SI) changes in the base model's direct runs. `campaign`: of the model
/// with the effect. `trial`: numbers the strengths that are tried on it. Throws TooFewRuns.
EffectChange change_with(const StudiedModel& base, const ModelEffect& effect, Campaign& campaign,
                         double strength, std::uint64_t trial = 0);

/// The fingerprint of the effect: at its prior's median strength (the upper 16 % point where the strength may
/// be negative), or, where that drowns in the scatter of the packings, at a greater one that shows, up to the
/// prior's 95 % point. Throws TooFewRuns.
Probe probe_effect(const StudiedModel& base, const ModelEffect& effect, const lab_data::Sample& sample,
                   const std::filesystem::path& folder, RunLog* log);

/// The base model's training runs as runs of the model with the effect at strength 0; none where the effect
/// does not hold the base model at a strength of 0 that its prior allows.
std::vector<RunRecord> runs_without(const StudiedModel& base, const ModelEffect& effect,
                                    const ParameterSpace& space);

/// Where runs with the effect are made first: each parameter of the base about its estimate, those of the
/// effect wherever its prior lies.
Window window_with(const StudiedModel& base, const ParameterSpace& space);

}  // namespace loam::experiments
