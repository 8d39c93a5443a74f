#include "experiments/workflows/held_out_tests.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

constexpr double tolerable = 0.1;      // error of the largest stress
constexpr double least_shift = 0.005;  // of the void ratio, that is looked at

double void_ratio(double porosity) {
    return porosity / (1 - porosity);
}

/// Void ratio of the test's specimens as made, less that wanted: a mean over the runs.
double missed_void_ratio(Campaign& campaign, const CampaignTest& test, const std::vector<RunRecord>& runs) {
    double sum = 0;
    for (const RunRecord& run : runs) sum += void_ratio(campaign.specimen(test, run.spec)->porosity);
    return sum / static_cast<double>(runs.size()) - void_ratio(test.porosity);
}

/// How much looser than measured the fitted tests of that kind were made, on average; none without any.
std::optional<double> missed_by_fitted(Campaign& campaign, lab_data::TestKind kind,
                                       const std::vector<RunRecord>& runs) {
    double sum = 0, count = 0;
    for (const CampaignTest& test : campaign.tests()) {
        if (test.held_out || test.test->kind != kind) continue;
        sum += missed_void_ratio(campaign, test, runs);
        count += 1;
    }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
}

double largest(const CampaignCurve& curve, const Eigen::VectorXd& outputs) {
    return outputs.segment(curve.first, curve.count()).maxCoeff();
}

/// The sample with that test alone, at that void ratio.
lab_data::Sample only(const lab_data::Sample& sample, const CampaignTest& test, double at) {
    lab_data::Sample out = sample;
    out.tests = {*test.test};
    out.tests[0].initial_void_ratio = at;
    return out;
}

/// The largest stress of the curve with specimens whose void ratio is larger by `shift`; none where too few
/// of the runs come to an end.
std::optional<double> largest_if_shifted(const Campaign& campaign, const lab_data::Sample& sample,
                                         const CampaignCurve& curve, const Calibration& calibration,
                                         double shift, const std::filesystem::path& folder, RunLog* log,
                                         HeldOutFindings& findings) {
    Settings settings = campaign.settings();
    settings.hold_out.clear();
    settings.tests.clear();
    settings.specimen.porosity.reset();
    settings.specimen.match = "void_ratio";
    const double at = void_ratio(curve.test->porosity) + shift;
    if (at <= 0) return std::nullopt;
    const lab_data::Sample alike = only(sample, *curve.test, at);
    const std::filesystem::path place =
        folder / "held_out" / std::filesystem::path(curve.test->test->file).stem();
    std::filesystem::create_directories(place);
    Campaign alone(settings, alike, place, log);
    std::vector<RunSpec> specs;  // on the same packings, so that little is chance
    for (const RunRecord& run : calibration.confirmation) specs.push_back(run.spec);
    const std::vector<RunRecord> runs =
        alone.run(shift > 0 ? "held out, made looser" : "held out, made denser", specs);
    const auto failed =
        static_cast<std::size_t>(std::ranges::count_if(runs, [](const RunRecord& run) { return !run.ok; }));
    findings.runs += runs.size();
    findings.failed += failed;
    if (2 * failed > runs.size()) return std::nullopt;
    const Eigen::VectorXd mean = mean_outputs(runs);
    for (const CampaignCurve& same : alone.curves())
        if (same.channel == curve.channel) return largest(same, mean);
    throw std::logic_error("the held-out test's channel is not simulated");
}

/// By how much of void ratio the fitted tests of its kind are made looser than measured, compared with it;
/// none without such tests, or with a packing that was given.
std::optional<double> shift_of_fitted(Campaign& campaign, const CampaignTest& test,
                                      const std::vector<RunRecord>& runs) {
    if (!campaign.settings().packing.empty()) return std::nullopt;
    std::optional<double> shift = missed_by_fitted(campaign, test.test->kind, runs);
    if (shift) *shift -= missed_void_ratio(campaign, test, runs);
    return shift;
}

/// What the largest stress would be with specimens as far from the measured density as the fitted ones.
std::string part_of_density(double shift, std::optional<double> then, double predicted, double measured,
                            lab_data::TestKind kind) {
    if (std::abs(shift) <= least_shift)
        return "its specimens are as dense, against what was measured, as those of the fitted tests";
    const std::string apart = fmt::format(
        "compared with it, the fitted {} tests have specimens that are {} than measured by {:.3f} of "
        "void ratio",
        to_string(kind), shift > 0 ? "looser" : "denser", std::abs(shift));
    if (!then) return apart + ", and specimens like that cannot be simulated here";
    const double part = std::min(1.0, (predicted - *then) / (predicted - measured));
    return fmt::format("{}, and made so too it has {} ({:+.0f} %) by direct runs: density is {} of the error",
                       apart, readable(*then, "Pa"), 100 * (*then / measured - 1),
                       part > 0 ? fmt::format("{:.0f} %", 100 * part) : "no part");
}

/// How the test's other channels end, which tells whether it is the strength alone that is missed.
std::string other_channels(const Campaign& campaign, const CampaignCurve& but,
                           const Eigen::VectorXd& outputs) {
    std::string text;
    for (const CampaignCurve& curve : campaign.curves()) {
        if (curve.test != but.test || curve.channel == but.channel) continue;
        const Eigen::VectorXd measured = curve.measured();
        text += fmt::format("; its {} ends at {}, measured {}", curve.channel->name,
                            readable(outputs[curve.first + curve.count() - 1], curve.channel->unit),
                            readable(measured[measured.size() - 1], curve.channel->unit));
    }
    return text;
}

}  // namespace

HeldOutFindings explain_held_out(Campaign& campaign, const lab_data::Sample& sample,
                                 const Calibration& calibration, const std::filesystem::path& folder,
                                 RunLog* log) {
    HeldOutFindings out;
    for (const CampaignCurve& curve : campaign.curves()) {
        if (!curve.test->held_out || curve.channel->unit != "Pa") continue;
        const double measured = curve.measured().maxCoeff(),
                     predicted = largest(curve, calibration.simulated), error = predicted / measured - 1;
        if (!(std::abs(error) > tolerable)) continue;
        std::string text =
            fmt::format("{}, held out: its largest {} is predicted as {}, measured as {} ({:+.0f} %)",
                        curve.test->test->file, curve.channel->name, readable(predicted, "Pa"),
                        readable(measured, "Pa"), 100 * error);
        if (const auto shift = shift_of_fitted(campaign, *curve.test, calibration.confirmation)) {
            std::optional<double> then;
            if (std::abs(*shift) > least_shift)
                then = largest_if_shifted(campaign, sample, curve, calibration, *shift, folder, log, out);
            text += "; " + part_of_density(*shift, then, predicted, measured, curve.test->test->kind);
        }
        text += other_channels(campaign, curve, calibration.simulated) +
                "; what density does not explain is the model's: loam diagnose asks what it lacks";
        out.warnings.push_back(std::move(text));
    }
    return out;
}

}  // namespace loam::experiments
