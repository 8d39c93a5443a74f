#include "experiments/workflows/sample_diagnosis.hpp"

#include <fmt/format.h>

#include "experiments/diagnosis/thresholds.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/workflows/calibration_report.hpp"
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

Diagnosis diagnose(StudiedModel& base, const lab_data::Sample& sample, const std::filesystem::path& folder,
                   RunLog& log, const StepReport& report) {
    Diagnosis out;
    out.base = &base;
    out.first = search_for_effect(base, sample, folder, &log, report);
    if (Leader* leader = half_an_explanation(out.first)) {
        out.on_top_of = leader->effect->name;
        report(fmt::format("{} helps but is not enough: a second effect on top of it", out.on_top_of));
        out.second = std::make_unique<Search>(
            search_for_effect(*leader->model, sample, folder / "effects" / out.on_top_of, &log, report));
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

}  // namespace

SampleDiagnosis diagnose_sample(const Settings& settings, const lab_data::Sample& sample,
                                const std::filesystem::path& folder, RunLog& log, const StepReport& report) {
    report("calibration of the base model");
    SampleDiagnosis out;
    out.base = study_model(settings, sample, folder, &log);
    out.diagnosis = diagnose(*out.base, sample, folder, log, report);
    out.outcome = outcome_of(out.diagnosis, sample);
    const Diagnosis& d = out.diagnosis;
    json& result = out.result;
    result = common_result(settings, sample.name, out.base->campaign, warnings_of(sample, *out.base, d));
    std::tie(result["dem_runs"], result["dem_failed"]) = runs_of(d);
    result.update(diagnosis_result(d, out.outcome, run_seed(settings.seed, 0, gap_stream)));
    const StudiedModel& last = *out.outcome.model;
    result["parameters"] = parameters_result(summarise(last.campaign, last.calibration.fit));
    result["extended_model"] = model_result(last.settings());
    result["tests"] = tests_result(out.base->campaign, out.base->simulated);
    return out;
}

}  // namespace loam::experiments
