#include "experiments/workflows/calibrate.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "experiments/calibration.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/output/log.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/calibration_report.hpp"
#include "experiments/workflows/held_out_tests.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

std::string table(const std::vector<ParameterSummary>& parameters, const json& result,
                  const std::string& report) {
    std::string text =
        fmt::format("{:<17} {:>11} {:>26}  {}\n", "parameter", "estimate", "90 % interval", "unit");
    for (const ParameterSummary& p : parameters) {
        const std::string interval = p.fixed ? "fixed" : fmt::format("{:.4g} .. {:.4g}", p.q05, p.q95);
        text += fmt::format("{:<17} {:>11.4g} {:>26}  {}{}\n", p.name, p.estimate, interval, p.unit,
                            p.fixed || p.identified ? "" : "  (not identified)");
    }
    for (const json& test : result["tests"]) {
        const bool staged = test.contains("rmse_loading");
        text += fmt::format(
            "{}{}: error of direct DEM runs {}{}, {} readings{}\n", test["file"].get<std::string>(),
            staged ? "" : " " + test["channel"].get<std::string>(),
            readable(test["rmse"].get<double>(), test["unit"].get<std::string>()),
            staged ? fmt::format(" ({:.2e} over the loading stages)", test["rmse_loading"].get<double>())
                   : "",
            test["points"].get<std::size_t>(), test["held_out"].get<bool>() ? ", held out" : "");
    }
    for (const json& warning : result["warnings"])
        text += fmt::format("warning: {}\n", warning.get<std::string>());
    return text + fmt::format("report: {}\n", report);
}

/// What the model cannot follow, SI, of every fitted curve by file and channel.
json misfits_result(const Campaign& campaign, const Fit& fit) {
    std::vector<Eigen::Index> columns;
    const Observation observation = observation_of(campaign, columns);
    json out = json::array();
    std::size_t at = 0;
    for (const CampaignCurve& curve : campaign.curves()) {
        if (curve.test->held_out) continue;
        const ObservedCurve& observed = observation.curves[at++];
        out.push_back({{"file", curve.test->test->file},
                       {"channel", curve.channel->name},
                       {"sd", observed.misfit_sd(fit.misfits)},
                       {"unit", curve.channel->unit}});
    }
    return out;
}

}  // namespace

int run_calibrate(const Settings& settings) {
    const auto started = std::chrono::steady_clock::now();
    const lab_data::Sample sample = lab_data::read_sample(settings.sample);
    const RunFolder folder(settings);
    RunLog log(folder.file("log.txt"));
    log.write(fmt::format("loam {} calibrate {}{}", LOAM_VERSION, settings.sample.string(),
                          folder.resumed() ? " (resumed)" : ""));
    Campaign campaign(settings, sample, folder.path(), &log);
    const Calibration calibration = calibrate(campaign);
    for (const CalibrationRound& round : calibration.rounds) log.write(round.text);

    std::vector<std::string> warnings = sample.warnings;
    for (const auto* more : {&campaign.warnings(), &calibration.warnings})
        warnings.insert(warnings.end(), more->begin(), more->end());
    for (std::string& text : density_warnings(campaign, calibration.confirmation))
        warnings.push_back(std::move(text));
    HeldOutFindings held_out = explain_held_out(campaign, sample, calibration, folder.path(), &log);
    for (std::string& text : held_out.warnings) warnings.push_back(std::move(text));

    const std::vector<ParameterSummary> parameters = summarise(campaign, calibration.fit);
    json result = common_result(settings, sample.name, campaign, warnings);
    result["parameters"] = parameters_result(parameters);
    result["tests"] = tests_result(campaign, calibration.simulated);
    result["misfit_sd"] = misfits_result(campaign, calibration.fit);
    result["stopped_by"] = calibration.stopped_by;
    result["dem_runs"] = result["dem_runs"].get<std::size_t>() + held_out.runs;
    result["dem_failed"] = result["dem_failed"].get<std::size_t>() + held_out.failed;
    json document = calibration_document(campaign, sample, calibration, parameters, result);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    result["seconds"] = seconds;
    document["seconds"] = seconds;
    write_file_atomically(folder.file("report.json"), document.dump() + "\n");
    write_file_atomically(folder.file("report.html"), report_html(document));
    write_file_atomically(folder.file("result.json"), result.dump(1) + "\n");
    log.write(fmt::format("done in {:.1f} s", seconds));
    print_result(settings, result, table(parameters, result, folder.file("report.html").string()));
    return 0;
}

}  // namespace loam::experiments
