#include "experiments/workflows/simulate.hpp"

#include <fmt/format.h>

#include <chrono>

#include "experiments/calibration.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/output/log.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/settings/writing.hpp"
#include "experiments/workflows/calibration_report.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

std::vector<std::string> unset_warnings(const Campaign& campaign) {
    std::vector<std::string> out;
    const ParameterSpace& space = campaign.space();
    for (const std::size_t p : space.fitted)
        out.push_back(fmt::format("{} is not set; the median of its prior is used: {:.4g} {}",
                                  space.parameters[p].name, space.values[static_cast<Eigen::Index>(p)],
                                  space.parameters[p].unit));
    return out;
}

/// The curves of result.json: x, measured and simulated are parallel.
json curves_result(const json& tests) {
    json out = json::array();
    for (const json& test : tests)
        out.push_back({{"file", test["file"]},
                       {"channel", test["channel"]},
                       {"x", test["x"]},
                       {"measured", test["measured"]},
                       {"simulated", test["simulated"]}});
    return out;
}

json parameters_document(const Campaign& campaign) {
    json out = json::array();
    const ParameterSpace& space = campaign.space();
    for (std::size_t p = 0; p < space.parameters.size(); ++p) {
        const engine::ParameterInfo& info = space.parameters[p];
        out.push_back({{"name", info.name},
                       {"symbol", info.symbol},
                       {"unit", info.unit},
                       {"meaning", info.meaning},
                       {"estimate", space.values[static_cast<Eigen::Index>(p)]},
                       {"fixed", true},
                       {"log", false}});
    }
    return out;
}

/// A unit in which people read numbers, and how much of SI it is.
struct ShownUnit {
    double size;
    std::string text;
};

ShownUnit shown_unit(std::string_view si) {
    if (si == "Pa") return {1000, " (kPa)"};
    if (si == "m") return {1e-3, " (mm)"};
    return {1, ""};
}

std::string table(const json& tests, const json& warnings, const std::string& report) {
    std::string text;
    for (const json& test : tests) {
        const ShownUnit of_x = shown_unit(test["x_unit"].get<std::string>()),
                        of_y = shown_unit(test["unit"].get<std::string>());
        const double x_unit = of_x.size, unit = of_y.size;
        text += fmt::format("{} {}{}\n{:>24} {:>12} {:>12}\n", test["file"].get<std::string>(),
                            test["channel"].get<std::string>(), of_y.text,
                            test["x_name"].get<std::string>() + of_x.text, "measured", "simulated");
        for (std::size_t k = 0; k < test["x"].size(); ++k)
            text += fmt::format("{:>24.4g} {:>12.6g} {:>12.6g}\n", test["x"][k].get<double>() / x_unit,
                                test["measured"][k].get<double>() / unit,
                                test["simulated"][k].get<double>() / unit);
        text += fmt::format("error {}, {} readings\n",
                            readable(test["rmse"].get<double>(), test["unit"].get<std::string>()),
                            test["points"].get<std::size_t>());
    }
    for (const json& warning : warnings) text += fmt::format("warning: {}\n", warning.get<std::string>());
    return text + fmt::format("report: {}\n", report);
}

}  // namespace

int run_simulate(const Settings& settings) {
    const auto started = std::chrono::steady_clock::now();
    const lab_data::Sample sample = lab_data::read_sample(settings.sample);
    const RunFolder folder(settings);
    RunLog log(folder.file("log.txt"));
    log.write(fmt::format("loam {} simulate {}", LOAM_VERSION, settings.sample.string()));
    Campaign campaign(settings, sample, folder.path(), &log);
    const int packings = settings.packing.empty() ? settings.calibration.confirmation_packings : 1;
    const std::vector<RunRecord> runs = direct_runs(campaign, campaign.space().values, 0, packings);
    const Eigen::VectorXd simulated = mean_outputs(runs);

    std::vector<std::string> warnings = sample.warnings;
    for (const auto& more : {campaign.warnings(), unset_warnings(campaign)})
        warnings.insert(warnings.end(), more.begin(), more.end());
    for (std::string& text : density_warnings(campaign, runs)) warnings.push_back(std::move(text));
    json result = common_result(settings, sample.name, campaign, warnings);
    result["tests"] = tests_result(campaign, simulated);
    json document = result;
    document["tests"] = curves_document(campaign, runs, simulated, result["tests"]);
    result["curves"] = curves_result(document["tests"]);
    document["description"] = sample.description;
    document["verdict"] = fmt::format("Mean of {} direct DEM runs with the given parameters.", runs.size());
    document["parameters"] = parameters_document(campaign);
    document["packing"] = packing_document(campaign, runs.front().spec);
    document["quasi_static"] = quasi_static_document(runs);
    document["settings"] = to_toml(settings);
    result["seconds"] = document["seconds"] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    write_file_atomically(folder.file("report.json"), document.dump() + "\n");
    write_file_atomically(folder.file("report.html"), report_html(document));
    write_file_atomically(folder.file("result.json"), result.dump(1) + "\n");
    print_result(settings, result,
                 table(document["tests"], result["warnings"], folder.file("report.html").string()));
    return 0;
}

}  // namespace loam::experiments
