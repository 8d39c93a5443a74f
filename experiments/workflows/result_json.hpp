// The members of result.json that verbs share (schema: tests/schema/result.schema.json).
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/campaign.hpp"
#include "experiments/workflows/parameter_summary.hpp"

namespace loam::experiments {

/// Members that every verb has, without `seconds`; counts are those of the store.
nlohmann::json common_result(const Settings& settings, std::string_view name, const Campaign& campaign,
                             const std::vector<std::string>& warnings);

/// The `parameters` member.
nlohmann::json parameters_result(const std::vector<ParameterSummary>& parameters);

nlohmann::json model_result(const Settings& settings);

/// How simulated curves [outputs] (SI) compare with the measured ones.
struct CurveError {
    double rmse = 0, mean_error = 0, rmse_loading = 0;
    std::optional<double> pearson_r;  // none for fewer than three readings or a constant curve
};
CurveError curve_error(const CampaignCurve& curve, const Eigen::VectorXd& simulated);

/// The `tests` member: one entry for each of the campaign's curves, in their order.
nlohmann::json tests_result(const Campaign& campaign, const Eigen::VectorXd& simulated);

/// A curve's number with its unit, in those that people read: "12.3 kPa", "4.0e-03 m/m".
std::string readable(double value, std::string_view unit);

/// Sends result.json's text to standard output under --json, else the short text.
void print_result(const Settings& settings, const nlohmann::json& result, const std::string& text);

}  // namespace loam::experiments
