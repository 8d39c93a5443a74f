#include "experiments/workflows/diagnose.hpp"

#include <fmt/format.h>

#include <chrono>

#include "experiments/diagnosis/thresholds.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/output/log.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/settings/writing.hpp"
#include "experiments/workflows/calibration_report.hpp"
#include "experiments/workflows/diagnosis_outcome.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using nlohmann::json;

constexpr std::uint64_t gap_stream = 22;

/// The leader that predicts best though it does not fit yet, or nullptr: what a second effect may stand on.
Leader* half_an_explanation(Search& search) {
    if (search.verdict.kind != VerdictKind::outside_library) return nullptr;
    Leader* best = nullptr;
    for (Leader& leader : search.leaders)
        if (leader.finalist.held_out_gain > thresholds::gain_of_second &&
            (!best || leader.finalist.held_out_gain > best->finalist.held_out_gain))
            best = &leader;
    return best;
}

Diagnosis diagnose(StudiedModel& base, const lab_data::Sample& sample, const RunFolder& folder, RunLog& log,
                   const StepReport& report) {
    Diagnosis out;
    out.base = &base;
    out.first = search_for_effect(base, sample, folder.path(), &log, report);
    if (Leader* leader = half_an_explanation(out.first)) {
        out.on_top_of = leader->effect->name;
        report(fmt::format("{} helps but is not enough: a second effect on top of it", out.on_top_of));
        out.second = std::make_unique<Search>(search_for_effect(
            *leader->model, sample, folder.path() / "effects" / out.on_top_of, &log, report));
        // Two names are two chances to be wrong.
        Verdict& verdict = out.second->verdict;
        if (verdict.kind == VerdictKind::named) {
            const Leader& second = *out.second->leader(verdict.effects.front());
            if (second.finalist.held_out_gain < thresholds::gain_of_second)
                verdict.kind = VerdictKind::ambiguous;
        }
    }
    return out;
}

std::pair<std::size_t, std::size_t> runs_of(const Diagnosis& d) {
    std::size_t runs = d.base->campaign.store().size(), failed = failed_count(d.base->campaign.store());
    for (const Search* search : {&d.first, static_cast<const Search*>(d.second.get())}) {
        if (!search) continue;
        for (const Probe& probe : search->probes) {
            if (search->leader(probe.effect->name)) continue;  // whose ensemble holds them
            runs += probe.runs;
            failed += probe.failed;
        }
        for (const Leader& leader : search->leaders) {
            runs += leader.model->campaign.store().size();
            failed += failed_count(leader.model->campaign.store());
        }
    }
    return {runs, failed};
}

std::vector<std::string> warnings_of(const lab_data::Sample& sample, StudiedModel& base, const Diagnosis& d) {
    std::vector<std::string> out = sample.warnings;
    const auto add = [&](const std::vector<std::string>& more) {
        out.insert(out.end(), more.begin(), more.end());
    };
    add(base.campaign.warnings());
    add(base.calibration.warnings);
    add(density_warnings(base.campaign, base.direct));
    add(d.first.warnings);
    if (d.second) add(d.second->warnings);
    return out;
}

std::string text_of(const json& result, const std::string& report) {
    std::string text = fmt::format("{}: {}\n\n{:<46} {:<18} {:>7}\n", result["verdict"].get<std::string>(),
                                   result["text"].get<std::string>(), "test, channel", "region", "z");
    for (const json& region : result["regions"])
        text += fmt::format("{:<46} {:<18} {:>7.1f}\n",
                            region["test"].get<std::string>() + ", " + region["channel"].get<std::string>(),
                            region["region"].get<std::string>(), region["z"].get<double>());
    text += fmt::format("\n{:<22} {:>12} {:>12} {:>14} {:>8}\n", "effect", "log score", "probability",
                        "held-out gain", "fit p");
    for (const json& c : result["candidates"]) {
        const bool led = c["stage"] == "ensemble";
        text += fmt::format("{:<22} {:>12.1f} {:>12.2f} {:>14} {:>8}\n", c["effect"].get<std::string>(),
                            c["log_score"].get<double>(), c["probability"].get<double>(),
                            led ? fmt::format("{:.1f}", c["held_out_gain"].get<double>()) : "-",
                            led ? fmt::format("{:.2g}", c["fit_p"].get<double>()) : "-");
    }
    if (!result["shrink"].is_null())
        text += fmt::format("\nheld-out gap: {:.2f} before, {:.2f} after (1: noise alone)\n",
                            result["gap_before"].get<double>(), result["gap_after"].get<double>());
    if (!result["next_test"].is_null())
        text += fmt::format("next: {}\n", result["next_test"].get<std::string>());
    for (const json& warning : result["warnings"])
        text += fmt::format("warning: {}\n", warning.get<std::string>());
    return text + fmt::format("report: {}\n", report);
}

json report_document(StudiedModel& base, const Diagnosis& d, const Outcome& outcome, const json& result) {
    json document = result;
    document["verdict"] = outcome.sentence;
    document["diagnosis"] = diagnosis_document(d, outcome);
    for (const char* member :
         {"regions", "candidates", "threshold", "p_value", "next_test", "gap_before", "gap_after", "shrink"})
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
    report("calibration of the base model");
    const auto base = study_model(settings, sample, folder.path(), &log);
    const Diagnosis d = diagnose(*base, sample, folder, log, report);
    const Outcome outcome = outcome_of(d, sample);

    json result = common_result(settings, sample.name, base->campaign, warnings_of(sample, *base, d));
    std::tie(result["dem_runs"], result["dem_failed"]) = runs_of(d);
    result.update(diagnosis_result(d, outcome, run_seed(settings.seed, 0, gap_stream)));
    result["parameters"] =
        parameters_result(summarise(outcome.model->campaign, outcome.model->calibration.fit));
    result["extended_model"] = model_result(outcome.model->settings());
    result["tests"] = tests_result(base->campaign, base->simulated);
    json document = report_document(*base, d, outcome, result);
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
