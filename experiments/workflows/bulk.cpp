#include "experiments/workflows/bulk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "experiments/bulk/bulk_report.hpp"
#include "experiments/bulk/bulk_result.hpp"
#include "experiments/bulk/study.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/output/log.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

std::string summary_text(const json& result, const std::filesystem::path& folder) {
    const json& overall = result["overall"];
    std::string text =
        fmt::format("{} of {} samples calibrated ({} of them not followed to 6.7e-3 m/m), {} failed\n",
                    overall["calibrated"].get<int>(), result["samples"].size(),
                    overall["not_followed"].get<int>(), overall["failed"].get<int>());
    if (overall["readings"].get<int>() > 0)
        text += fmt::format(
            "direct DEM runs on fresh packings: error {:.2e} m/m, mean error {:.2e} m/m, r {:.4f} ({} "
            "readings)\n",
            overall["rmse"].get<double>(), overall["me"].get<double>(), overall["pearson_r"].get<double>(),
            overall["readings"].get<int>());
    for (const json& warning : result["warnings"])
        text += fmt::format("warning: {}\n", warning.get<std::string>());
    return text + fmt::format("parameters: {}\nreport: {}\n", (folder / "parameters.csv").string(),
                              (folder / "report.html").string());
}

}  // namespace

json calibrate_data_set(const Settings& settings, const lab_data::DataSet& set,
                        const std::filesystem::path& folder, RunLog& log) {
    const auto started = std::chrono::steady_clock::now();
    SharedEnsemble ensemble(settings, set, folder, &log);
    const BulkStudy study = run_study(ensemble, set, settings, folder, log);

    std::vector<std::string> warnings = set.warnings;
    for (const auto* more : {&ensemble.campaign().warnings(), &study.warnings})
        warnings.insert(warnings.end(), more->begin(), more->end());
    json result = common_result(settings, set.name, ensemble.campaign(), warnings);
    add_study(result, study, set, ensemble.space());
    const GroupStatistics statistics =
        group_statistics(study, set, ensemble.space(), settings.bulk.paired_by);
    json document = bulk_document(result, study, statistics, set, ensemble, settings);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    result["seconds"] = document["seconds"] = seconds;
    write_file_atomically(folder / "report.json",
                          document.dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
    write_file_atomically(folder / "report.html", report_html(document));
    write_file_atomically(folder / "parameters.csv", parameters_csv(study, set, ensemble.space()));
    write_file_atomically(folder / "result.json", result.dump(1) + "\n");
    log.write(fmt::format("done in {:.1f} s", seconds));
    return result;
}

int run_bulk(const Settings& settings) {
    const lab_data::DataSet set = lab_data::read_data_set(settings.sample);
    const RunFolder folder(settings);
    RunLog log(folder.file("log.txt"));
    log.write(fmt::format("loam {} bulk {}{}", LOAM_VERSION, settings.sample.string(),
                          folder.resumed() ? " (resumed)" : ""));
    const json result = calibrate_data_set(settings, set, folder.path(), log);
    print_result(settings, result, summary_text(result, folder.path()));
    return 0;
}

}  // namespace loam::experiments
