// The report's document of a calibration (experiments/report/README.md lists its members).
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/calibration.hpp"
#include "experiments/workflows/parameter_summary.hpp"

namespace loam::experiments {

/// `result`: the members of result.json so far. Runs the specimen once more, for its picture.
nlohmann::json calibration_document(Campaign& campaign, const lab_data::Sample& sample,
                                    const Calibration& calibration,
                                    const std::vector<ParameterSummary>& parameters,
                                    const nlohmann::json& result);

/// The `tests` member: measured and simulated curves; `bands` may be null.
nlohmann::json curves_document(const Campaign& campaign, const std::vector<RunRecord>& runs,
                               const Eigen::VectorXd& simulated, const nlohmann::json& tests);

/// The `packing` member: the specimen of that run under the highest measured stress, with its contact forces.
nlohmann::json packing_document(Campaign& campaign, const RunSpec& spec);

/// The `quasi_static` member.
nlohmann::json quasi_static_document(const std::vector<RunRecord>& runs);

}  // namespace loam::experiments
