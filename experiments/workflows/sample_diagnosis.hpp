// A sample's diagnosis from its calibration to the members of result.json: what loam diagnose does for its
// user and loam bench diagnose for every twin.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "experiments/workflows/diagnosis_outcome.hpp"

namespace loam::experiments {

/// `diagnosis` and `outcome` refer to `base`.
struct SampleDiagnosis {
    std::unique_ptr<StudiedModel> base;
    Diagnosis diagnosis;
    Outcome outcome;
    nlohmann::json result;  // result.json but for `seconds`
};

/// Keeps ensemble.h5 (of the base model) and effects/NAME/ensemble.h5 in `folder`; runs found there are not
/// made again. `report` is told of every step. Throws UserError, StorageError, Interrupted,
/// std::runtime_error.
SampleDiagnosis diagnose_sample(const Settings& settings, const lab_data::Sample& sample,
                                const std::filesystem::path& folder, RunLog& log, const StepReport& report);

}  // namespace loam::experiments
