#include "experiments/workflows/result_json.hpp"

#include <fmt/format.h>

#include <cmath>

namespace loam::experiments {

using nlohmann::json;

json parameters_result(const std::vector<ParameterSummary>& parameters) {
    json out = json::object();
    for (const ParameterSummary& p : parameters)
        out[p.name] = {{"unit", p.unit}, {"estimate", p.estimate},     {"q05", p.q05},    {"q50", p.q50},
                       {"q95", p.q95},   {"identified", p.identified}, {"fixed", p.fixed}};
    return out;
}

json model_result(const Settings& settings) {
    return {{"law", settings.law},
            {"rotation", settings.rotation},
            {"effects", settings.effects},
            {"density_scaling", settings.engine.density_scaling}};
}

json common_result(const Settings& settings, std::string_view name, const Campaign& campaign,
                   const std::vector<std::string>& warnings) {
    return {{"verb", settings.verb},
            {"name", name},
            {"version", LOAM_VERSION},
            {"seed", settings.seed},
            {"dem_runs", campaign.store().size()},
            {"dem_failed", failed_count(campaign.store())},
            {"warnings", warnings},
            {"model", model_result(settings)}};
}

CurveError curve_error(const CampaignCurve& curve, const Eigen::VectorXd& simulated) {
    const CampaignTest& test = *curve.test;
    const Eigen::VectorXd measured = curve.measured();
    CurveError out;
    double n = 0, n_loading = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    for (Eigen::Index k = 0; k < curve.count(); ++k) {
        const double x = measured[k], y = simulated[curve.first + k], e = y - x;
        out.rmse += e * e;
        out.mean_error += e;
        const std::size_t reading = test.readings[static_cast<std::size_t>(k)];
        if (test.test->phase.empty() || test.test->phase[reading] == "loading") {
            out.rmse_loading += e * e;
            n_loading += 1;
        }
        n += 1;
        sx += x;
        sy += y;
        sxx += x * x;
        syy += y * y;
        sxy += x * y;
    }
    out.rmse = std::sqrt(out.rmse / n);
    out.mean_error /= n;
    out.rmse_loading = n_loading > 0 ? std::sqrt(out.rmse_loading / n_loading) : 0;
    const double vx = sxx - sx * sx / n, vy = syy - sy * sy / n;
    if (n >= 3 && vx > 0 && vy > 0) out.pearson_r = (sxy - sx * sy / n) / std::sqrt(vx * vy);
    return out;
}

json tests_result(const Campaign& campaign, const Eigen::VectorXd& simulated) {
    json tests = json::array();
    for (const CampaignCurve& curve : campaign.curves()) {
        const lab_data::Test& test = *curve.test->test;
        const CurveError error = curve_error(curve, simulated);
        json entry{{"kind", to_string(test.kind)},
                   {"file", test.file},
                   {"channel", curve.channel->name},
                   {"rmse", error.rmse},
                   {"mean_error", error.mean_error},
                   {"unit", curve.channel->unit},
                   {"r", nullptr},
                   {"points", curve.count()},
                   {"held_out", curve.test->held_out}};
        if (test.kind == lab_data::TestKind::oedometer) entry["rmse_loading"] = error.rmse_loading;
        if (error.pearson_r) entry["r"] = *error.pearson_r;
        tests.push_back(std::move(entry));
    }
    return tests;
}

std::string readable(double value, std::string_view unit) {
    if (unit == "Pa") return fmt::format("{:.3g} kPa", value / 1000);
    if (unit == "m") return fmt::format("{:.3g} mm", value * 1000);
    return fmt::format("{:.2e} {}", value, unit);
}

void print_result(const Settings& settings, const json& result, const std::string& text) {
    if (settings.json)
        fmt::print("{}\n", result.dump(1));
    else
        fmt::print("{}", text);
}

}  // namespace loam::experiments
