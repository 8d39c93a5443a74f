// loam bulk: calibrates every sample of a data set from one shared ensemble.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/output/log.hpp"
#include "experiments/settings/settings.hpp"
#include "lab_data/data_set.hpp"

namespace loam::experiments {

/// The whole study of a data set: keeps its runs and fits in `folder`, writes result.json, report.json,
/// report.html and parameters.csv there, and returns what result.json holds. Throws UserError, StorageError,
/// Interrupted, std::runtime_error.
nlohmann::json calibrate_data_set(const Settings& settings, const lab_data::DataSet& set,
                                  const std::filesystem::path& folder, RunLog& log);

int run_bulk(const Settings& settings);

}  // namespace loam::experiments
