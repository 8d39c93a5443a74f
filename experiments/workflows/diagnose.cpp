#include "experiments/workflows/diagnose.hpp"

#include <fmt/format.h>

#include <chrono>

#include "experiments/output/atomic_file.hpp"
#include "experiments/output/log.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/settings/writing.hpp"
#include "experiments/workflows/calibration_report.hpp"
#include "experiments/workflows/result_json.hpp"
#include "experiments/workflows/sample_diagnosis.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

std::string text_of(const json& result, const std::string& report) {
    std::string text = fmt::format("{}: {}\n\n{:<46} {:<18} {:>7}\n", result["verdict"].get<std::string>(),
                                   result["text"].get<std::string>(), "test, channel", "region", "z");
    for (const json& region : result["regions"])
        text += fmt::format("{:<46} {:<18} {:>7.1f}\n",
                            region["test"].get<std::string>() + ", " + region["channel"].get<std::string>(),
                            region["region"].get<std::string>(), region["z"].get<double>());
    text += fmt::format("\n{:<22} {:>12} {:>12} {:>14} {:>8} {:>10}\n", "effect", "log score", "probability",
                        "held-out gain", "fit p", "strength");
    for (const json& c : result["candidates"]) {
        const bool led = c["stage"] == "ensemble";
        text += fmt::format(
            "{:<22} {:>12.1f} {:>12.2f} {:>14} {:>8} {:>10}\n", c["effect"].get<std::string>(),
            c["log_score"].get<double>(), c["probability"].get<double>(),
            led ? fmt::format("{:.1f}", c["held_out_gain"].get<double>()) : "-",
            led ? fmt::format("{:.2g}", c["fit_p"].get<double>()) : "-",
            led && c["strength"].is_number() ? fmt::format("{:.3g}", c["strength"].get<double>()) : "-");
    }
    if (!result["shrink"].is_null())
        text += fmt::format("\nheld-out gap: {:.2f} before, {:.2f} after (in noises, beyond noise alone)\n",
                            result["gap_before"].get<double>(), result["gap_after"].get<double>());
    for (const json& pair : result["sets"]) {
        const auto chance = [](const json& at) {
            return fmt::format("chi-squared {:.3g} on {} (p = {:.2g})", at["statistic"].get<double>(),
                               at["degrees"].get<int>(), at["p_value"].get<double>());
        };
        text += fmt::format("sets by {} and by {} alone: {}", pair["kinds"][0].get<std::string>(),
                            pair["kinds"][1].get<std::string>(), chance(pair["before"]));
        text += pair["after"].is_null() ? "\n" : fmt::format("; with the effect {}\n", chance(pair["after"]));
    }
    if (!result["next_test"].is_null())
        text += fmt::format("next: {}\n", result["next_test"].get<std::string>());
    for (const json& warning : result["warnings"])
        text += fmt::format("warning: {}\n", warning.get<std::string>());
    return text + fmt::format("report: {}\n", report);
}

json report_document(const SampleDiagnosis& done) {
    const StudiedModel& base = *done.base;
    const Outcome& outcome = done.outcome;
    const json& result = done.result;
    json document = result;
    document["verdict"] = outcome.sentence;
    document["diagnosis"] = diagnosis_document(done.diagnosis, outcome);
    for (const char* member : {"regions", "candidates", "threshold", "p_value", "next_test", "gap_before",
                               "gap_after", "shrink", "sets"})
        document["diagnosis"][member] = result[member];
    document["diagnosis"]["verdict"] = result["verdict"];
    document["diagnosis"]["effects"] = outcome.effects;
    document["tests"] = curves_document(base.campaign, base.direct, base.simulated, result["tests"]);
    if (outcome.model != &base)
        document["diagnosis"]["tests_after"] =
            curves_document(outcome.model->campaign, outcome.model->direct, outcome.model->simulated,
                            tests_result(outcome.model->campaign, outcome.model->simulated));
    document.erase("parameters");
    document["quasi_static"] = quasi_static_document(base.direct);
    document["settings"] = to_toml(base.settings());
    return document;
}

}  // namespace

int run_diagnose(const Settings& settings) {
    const auto started = std::chrono::steady_clock::now();
    const lab_data::Sample sample = lab_data::read_sample(settings.sample);
    const RunFolder folder(settings);
    RunLog log(folder.file("log.txt"));
    log.write(fmt::format("loam {} diagnose {}{}", LOAM_VERSION, settings.sample.string(),
                          folder.resumed() ? " (resumed)" : ""));
    const StepReport report = [&](const std::string& step) {
        log.write(step);
        if (!settings.quiet) fmt::print(stderr, "{}\n", step);
    };
    SampleDiagnosis done = diagnose_sample(settings, sample, folder.path(), log, report);
    json document = report_document(done);
    json& result = done.result;
    result["seconds"] = document["seconds"] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    write_file_atomically(folder.file("report.json"), document.dump() + "\n");
    write_file_atomically(folder.file("report.html"), report_html(document));
    write_file_atomically(folder.file("result.json"), result.dump(1) + "\n");
    log.write(fmt::format("done in {:.1f} s", result["seconds"].get<double>()));
    print_result(settings, result, text_of(result, folder.file("report.html").string()));
    return 0;
}

}  // namespace loam::experiments
