#include "experiments/workflows/crosstest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>

#include "experiments/calibration.hpp"
#include "experiments/cross_test.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/calibration_report.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using lab_data::TestKind;
using nlohmann::json;

constexpr double false_alarms = 0.01;  // rate at which sets that agree are said not to

struct ParameterSet {
    const char* name;
    std::string words;
    Calibration calibration;
    std::vector<ParameterSummary> parameters;
};

using Sets = std::array<ParameterSet, 3>;  // triaxial, direct shear, joint

ParameterSet fit_set(Campaign& campaign, std::vector<RunRecord>& runs, const char* name, CalibrationTask task,
                     RunLog& log) {
    const std::string words = task.title;
    task.title += ": ";
    ParameterSet set{name, words, calibrate(campaign, runs, task), {}};
    for (const CalibrationRound& round : set.calibration.rounds) log.write(task.title + round.text);
    set.parameters = summarise(campaign, set.calibration.fit);
    return set;
}

Sets fit_sets(Campaign& campaign, RunLog& log) {
    const auto of = [](TestKind kind, std::uint64_t place, const char* title) {
        return CalibrationTask{.kinds = {kind}, .place = place, .title = title, .follows = true};
    };
    const CalibrationTask all{.title = "joint"};
    CalibrationTask of_triaxial = of(TestKind::triaxial, 1, "triaxial"),
                    of_shear = of(TestKind::direct_shear, 2, "direct shear");
    std::vector<RunRecord> runs = narrowing_runs(campaign, std::array{all, of_triaxial, of_shear});
    // The joint fit goes first: its runs lie where the others' are needed too.
    ParameterSet joint = fit_set(campaign, runs, "joint", all, log);
    for (const RunRecord& run : joint.calibration.confirmation) {
        of_triaxial.packings.push_back(run.spec.packing_seed);
        of_shear.packings.push_back(run.spec.packing_seed);
    }
    ParameterSet triaxial = fit_set(campaign, runs, "triaxial", of_triaxial, log);
    ParameterSet shear = fit_set(campaign, runs, "direct_shear", of_shear, log);
    return {std::move(triaxial), std::move(shear), std::move(joint)};
}

Agreement compare(const Campaign& campaign, const Sets& sets) {
    Eigen::VectorXd precision, mean;
    prior_as_normal(campaign.space(), precision, mean);
    const Index d = campaign.space().dimension();
    const auto gaussian = [&](const ParameterSet& set) { return gaussian_of(set.calibration.fit, d); };
    return compare_sets(gaussian(sets[0]), gaussian(sets[1]), precision, mean);
}

/// Each parameter's shift between the sets, on its own scale, with the probability of one as large by chance.
json differences_result(const Campaign& campaign, const Sets& sets, const Agreement& agreement) {
    json out = json::array();
    for (Index k = 0; k < campaign.space().dimension(); ++k) {
        const auto& info = campaign.space().info(k);
        const auto& prior = campaign.space().prior(k);
        const double from = sets[0].calibration.fit.posterior.draws.col(k).mean(),
                     to = sets[1].calibration.fit.posterior.draws.col(k).mean();
        const double sd = agreement.sd[k];
        out.push_back(
            {{"parameter", info.name},
             {"unit", info.unit},
             {"triaxial", prior.from_unit(from)},
             {"direct_shear", prior.from_unit(to)},
             {"z", sd > 0 ? agreement.difference[k] / sd : 0.0},
             {"p_value", sd > 0 ? std::erfc(std::abs(agreement.difference[k] / sd) / std::sqrt(2.0)) : 1.0}});
    }
    return out;
}

std::string shift_text(const json& d) {
    return fmt::format(
        "{} is {:.4g} {} by the triaxial tests and {:.4g} {} by direct shear ({:+.1f} standard "
        "deviations)",
        d["parameter"].get<std::string>(), d["triaxial"].get<double>(), d["unit"].get<std::string>(),
        d["direct_shear"].get<double>(), d["unit"].get<std::string>(), d["z"].get<double>());
}

std::string verdict_text(const Agreement& agreement, const json& differences) {
    std::string text =
        fmt::format("Triaxial and direct shear tests {} one parameter set (p = {:.2g})",
                    agreement.p_value >= false_alarms ? "agree on" : "do not agree on", agreement.p_value);
    if (agreement.degrees == 0) return text + ": the tests say too little to tell.";
    std::vector<json> order(differences.begin(), differences.end());
    std::ranges::sort(order, [](const json& a, const json& b) {
        return std::abs(a["z"].get<double>()) > std::abs(b["z"].get<double>());
    });
    text += agreement.p_value >= false_alarms ? "; the largest shift: " : ": ";
    text += shift_text(order.front());
    if (agreement.p_value < false_alarms)
        for (std::size_t k = 1; k < order.size(); ++k)
            if (order[k]["p_value"].get<double>() < false_alarms) text += "; " + shift_text(order[k]);
    return text + ".";
}

json errors_result(const Campaign& campaign, const Sets& sets) {
    json out = json::array();
    for (const ParameterSet& set : sets)
        for (const json& test : tests_result(campaign, set.calibration.simulated))
            out.push_back({{"set", set.name},
                           {"kind", test["kind"]},
                           {"file", test["file"]},
                           {"channel", test["channel"]},
                           {"rmse", test["rmse"]},
                           {"mean_error", test["mean_error"]},
                           {"unit", test["unit"]}});
    return out;
}

/// The report's section: every curve under every set.
json crosstest_document(const Campaign& campaign, const Sets& sets, const json& result) {
    json out{{"sets", json::array()},
             {"curves", json::array()},
             {"differences", result["differences"]},
             {"test", result["verdict"]["test"]}};
    for (const ParameterSet& set : sets) {
        json parameters = json::array();
        for (const ParameterSummary& p : set.parameters)
            if (!p.fixed)
                parameters.push_back({{"name", p.name},
                                      {"symbol", p.symbol},
                                      {"unit", p.unit},
                                      {"estimate", p.estimate},
                                      {"q05", p.q05},
                                      {"q95", p.q95}});
        out["sets"].push_back({{"name", set.words}, {"parameters", parameters}});
        json errors = json::array(), simulated = json::array();
        for (const CampaignCurve& curve : campaign.curves()) {
            const auto values = set.calibration.simulated.segment(curve.first, curve.count());
            simulated.push_back(std::vector<double>(values.begin(), values.end()));
            errors.push_back(curve_error(curve, set.calibration.simulated).rmse);
        }
        out["curves"].push_back({{"set", set.words}, {"simulated", simulated}, {"rmse", errors}});
    }
    return out;
}

std::string table(const Sets& sets, const json& result, const std::string& report) {
    std::string text =
        fmt::format("{:<17} {:>25} {:>25} {:>25}  unit\n", "parameter", "triaxial", "direct shear", "joint");
    for (std::size_t k = 0; k < sets[0].parameters.size(); ++k) {
        const ParameterSummary& first = sets[0].parameters[k];
        if (first.fixed) continue;
        text += fmt::format("{:<17}", first.name);
        for (const ParameterSet& set : sets) {
            const ParameterSummary& p = set.parameters[k];
            text +=
                fmt::format(" {:>25}", fmt::format("{:.3g} ({:.3g} .. {:.3g})", p.estimate, p.q05, p.q95));
        }
        text += "  " + first.unit + "\n";
    }
    const json& errors = result["errors"];
    const std::size_t curves = errors.size() / sets.size();
    text += fmt::format("{:<43} {:>12} {:>12} {:>12}\n", "error of direct DEM runs", "triaxial",
                        "direct shear", "joint");
    for (std::size_t c = 0; c < curves; ++c) {
        text += fmt::format(
            "{:<43}", errors[c]["file"].get<std::string>() + " " + errors[c]["channel"].get<std::string>());
        for (std::size_t s = 0; s < sets.size(); ++s) {
            const json& e = errors[s * curves + c];
            text += fmt::format(" {:>12}", readable(e["rmse"].get<double>(), e["unit"].get<std::string>()));
        }
        text += "\n";
    }
    text += result["verdict"]["text"].get<std::string>() + "\n";
    for (const json& warning : result["warnings"])
        text += fmt::format("warning: {}\n", warning.get<std::string>());
    return text + fmt::format("report: {}\n", report);
}

}  // namespace

int run_crosstest(const Settings& settings) {
    const auto started = std::chrono::steady_clock::now();
    const lab_data::Sample sample = lab_data::read_sample(settings.sample);
    const RunFolder folder(settings);
    RunLog log(folder.file("log.txt"));
    log.write(fmt::format("loam {} crosstest {}{}", LOAM_VERSION, settings.sample.string(),
                          folder.resumed() ? " (resumed)" : ""));
    Campaign campaign(settings, sample, folder.path(), &log);
    const Sets sets = fit_sets(campaign, log);
    const ParameterSet& joint = sets[2];
    const Agreement agreement = compare(campaign, sets);

    std::vector<std::string> warnings = sample.warnings;
    warnings.insert(warnings.end(), campaign.warnings().begin(), campaign.warnings().end());
    for (const ParameterSet& set : sets)
        for (const std::string& text : set.calibration.warnings)
            warnings.push_back(fmt::format("{}: {}", set.words, text));
    for (std::string& text : density_warnings(campaign, joint.calibration.confirmation))
        warnings.push_back(std::move(text));

    json result = common_result(settings, sample.name, campaign, warnings);
    for (const ParameterSet& set : sets)
        result["sets"][set.name] = {{"parameters", parameters_result(set.parameters)}};
    result["errors"] = errors_result(campaign, sets);
    result["differences"] = differences_result(campaign, sets, agreement);
    result["verdict"] = {
        {"agree", agreement.p_value >= false_alarms},
        {"p_value", agreement.p_value},
        {"statistic", agreement.statistic},
        {"degrees", agreement.degrees},
        {"false_alarm_rate", false_alarms},
        {"test",
         fmt::format(
             "chi-squared of the difference of what the two kinds of test say without the prior, on {} "
             "degrees of freedom; sets that agree are said not to in {:.0f} % of cases",
             agreement.degrees, 100 * false_alarms)},
        {"text", verdict_text(agreement, result["differences"])}};
    // The report is that of the joint fit, with the sets beside each other.
    json of_joint = result;
    of_joint["tests"] = tests_result(campaign, joint.calibration.simulated);
    json document = calibration_document(campaign, sample, joint.calibration, joint.parameters, of_joint);
    document["crosstest"] = crosstest_document(campaign, sets, result);
    document["verdict"] = result["verdict"]["text"];
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    result["seconds"] = document["seconds"] = seconds;
    write_file_atomically(folder.file("report.json"), document.dump() + "\n");
    write_file_atomically(folder.file("report.html"), report_html(document));
    write_file_atomically(folder.file("result.json"), result.dump(1) + "\n");
    log.write(fmt::format("done in {:.1f} s", seconds));
    print_result(settings, result, table(sets, result, folder.file("report.html").string()));
    return 0;
}

}  // namespace loam::experiments
