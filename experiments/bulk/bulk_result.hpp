// What a bulk study hands on: its members of result.json, and parameters.csv for further work.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Adds `samples`, `overall` and `parts` (seconds of each part of the work).
void add_study(nlohmann::json& result, const BulkStudy& study, const lab_data::DataSet& set,
               const ParameterSpace& space);

/// One row a sample: name, status, errors, each parameter with its 90 % interval (SI), and the data set's
/// covariates. Cells without a value are empty.
std::string parameters_csv(const BulkStudy& study, const lab_data::DataSet& set, const ParameterSpace& space);

}  // namespace loam::experiments
