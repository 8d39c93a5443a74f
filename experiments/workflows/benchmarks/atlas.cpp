// loam bench atlas: what each effect of the library does to the curves of each kind of test, by direct runs
// with and without it on common packings.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/calibration.hpp"
#include "experiments/diagnosis/probes.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/output/json_values.hpp"
#include "experiments/report/report.hpp"
#include "experiments/settings/parameters.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/settings/writing.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/twin_tests.hpp"
#include "experiments/workflows/calibration_report.hpp"
#include "experiments/workflows/result_json.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using nlohmann::json;

constexpr int default_particles = 400, packings = 6;
constexpr double box_diameters = 10;
constexpr double half_of_90 = 1.6449;  // normal quantile
constexpr double certain = 3;          // standard errors of the mean change

/// A dense sand under the GRAPE paper's law.
Settings model_of(const Settings& given) {
    Settings s = given;
    s.law = "linear-damped";
    s.rotation = "free";
    s.effects = {};
    s.set = {{"young_modulus", 1e8},
             {"stiffness_ratio", 0.6},
             {"friction_angle", 0.4},
             {"normal_damping", 0.1},
             {"tangential_damping", 0.1}};
    if (s.particles == Settings{}.particles) s.particles = default_particles;
    if (!s.direct_shear.box_diameters) s.direct_shear.box_diameters = box_diameters;
    return s;
}

lab_data::Sample atlas_tests() {
    lab_data::Sample sample = reference_sample();
    sample.name = "atlas";
    sample.tests.clear();
    sample.tests.push_back(oedometer_without_readings(
        2e3, {10e3, 20e3, 40e3, 80e3, 160e3, 320e3, 640e3, 1280e3, 320e3, 80e3, 20e3}));
    for (const double pressure : {50e3, 200e3}) {
        lab_data::Test test = test_without_readings(
            lab_data::TestKind::triaxial, fmt::format("triaxial_{:.0f}kPa.csv", pressure / 1e3),
            "axial_strain", 0.15, 20, {"deviatoric_stress", "volumetric_strain"});
        test.cell_pressure = pressure;
        sample.tests.push_back(std::move(test));
    }
    lab_data::Test shear =
        test_without_readings(lab_data::TestKind::direct_shear, "direct_shear_100kPa.csv",
                              "shear_displacement", 0.15, 20, {"shear_stress", "settlement"});
    shear.normal_stress = 100e3;
    shear.box_length = shear.box_width = 1;
    shear.box_height = 0.6;
    sample.tests.push_back(std::move(shear));
    for (lab_data::Test& test : sample.tests) test.initial_void_ratio = 0.68;
    return sample;
}

/// The change of one curve, in the shares of the range that the base's curve spans.
struct Change {
    double largest = 0;  // with its sign
    double at = 0;       // x there, SI
    bool is_certain = false;
};

struct Curves {
    VectorXd mean, sd;           // [m] of the runs
    VectorXd change, change_sd;  // [m] against the base on common packings; empty for the base
};

VectorXd row_sd(const Eigen::MatrixXd& columns) {
    const auto n = static_cast<double>(columns.cols());
    return ((columns.colwise() - columns.rowwise().mean()).rowwise().squaredNorm() / std::max(1.0, n - 1))
        .cwiseSqrt();
}

Curves compare(const std::vector<RunRecord>& base, const std::vector<RunRecord>& with) {
    Eigen::MatrixXd changes(base.front().outputs.size(), static_cast<Index>(with.size()));
    Index n = 0;
    for (std::size_t k = 0; k < with.size(); ++k)
        if (base[k].ok && with[k].ok) changes.col(n++) = with[k].outputs - base[k].outputs;
    if (n < 2) throw std::runtime_error("its runs fail: " + with.front().reason);
    changes.conservativeResize(Eigen::NoChange, n);
    return {mean_outputs(with), sd_outputs(with), changes.rowwise().mean(), row_sd(changes)};
}

Change largest_change(const CampaignCurve& curve, const VectorXd& base, const Curves& with, int runs) {
    const VectorXd x = curve.test->measured(curve.test->kind->x_name),
                   plain = base.segment(curve.first, curve.count()),
                   change = with.change.segment(curve.first, curve.count()),
                   error = with.change_sd.segment(curve.first, curve.count()) / std::sqrt(runs);
    Index at = 0;
    change.cwiseAbs().maxCoeff(&at);
    const double range = std::max(plain.maxCoeff(), 0.0) - std::min(plain.minCoeff(), 0.0);
    return {range > 0 ? change[at] / range : 0, x[at], std::abs(change[at]) > certain * error[at]};
}

json curve_json(const CampaignCurve& curve, const VectorXd& base, const VectorXd& base_sd, const Curves& with,
                const Change& change) {
    const CampaignTest& test = *curve.test;
    json phase = json::array();
    for (const std::size_t reading : test.readings)
        phase.push_back(test.test->phase.empty() ? "loading" : test.test->phase[reading]);
    const auto part = [&](const VectorXd& v) { return VectorXd(v.segment(curve.first, curve.count())); };
    return {{"file", test.test->file},
            {"channel", curve.channel->name},
            {"x_name", test.kind->x_name},
            {"x_unit", test.kind->x_unit},
            {"x_log", test.kind->x_logarithmic},
            {"y_unit", curve.channel->unit},
            {"x", values_of(test.measured(test.kind->x_name))},
            {"phase", phase},
            {"simulated", values_of(part(with.mean))},
            {"band_lower", values_of(part(base - half_of_90 * base_sd))},
            {"band_upper", values_of(part(base + half_of_90 * base_sd))},
            {"band_name", "without it, 90 % of packings"},
            {"change", values_of(part(with.change))},
            {"largest", change.largest},
            {"at", change.at},
            {"certain", change.is_certain}};
}

/// The effect's row of the atlas; its runs go into a sub-folder.
json row_of(const ModelEffect& effect, const Settings& base_settings, const Campaign& base,
            const std::vector<RunRecord>& base_runs, const lab_data::Sample& sample,
            const std::filesystem::path& folder, RunLog& log) {
    const std::filesystem::path place = folder_of(folder, effect);
    std::filesystem::create_directories(place);
    Settings settings = base_settings;
    add_effect(settings, effect);
    Campaign campaign(settings, sample, place, &log);
    VectorXd values = campaign.space().values;
    json row{{"effect", effect.name},
             {"meaning", effect.meaning},
             {"rotation", base_settings.rotation},
             {"strength", nullptr}};
    if (const surrogate::Prior* prior = prior_of_strength(effect, campaign.space())) {
        const double strength = prior->from_unit(prior->quantile_unit(prior->from_unit(0) < 0 ? 0.84 : 0.5));
        for (std::size_t p = 0; p < campaign.space().parameters.size(); ++p)
            if (campaign.space().parameters[p].name == effect.parameters.front().name)
                values[static_cast<Index>(p)] = strength;
        row["strength"] = strength;
        row["parameter"] = effect.parameters.front().name;
        row["unit"] = effect.parameters.front().unit;
    }
    const std::vector<RunRecord> runs =
        direct_runs(campaign, values, 0, packings, fmt::format("with {}: ", effect.name));
    const Curves with = compare(base_runs, runs);
    const VectorXd mean = mean_outputs(base_runs), sd = sd_outputs(base_runs);
    for (const CampaignCurve& curve : base.curves())
        row["curves"].push_back(
            curve_json(curve, mean, sd, with, largest_change(curve, mean, with, packings)));
    return row;
}

std::string to_text(const json& rows) {
    std::string out =
        "Largest change of each curve by each effect, in % of the range of the curve without it; in brackets "
        "where\nthat is within three standard errors.\n\n";
    out += fmt::format("{:22} {:>12}", "effect", "strength");
    for (std::size_t k = 0; k < rows.front()["curves"].size(); ++k)
        out += fmt::format(" {:>7}", fmt::format("({})", k + 1));
    out += "\n";
    for (const json& row : rows) {
        out += fmt::format(
            "{:22} {:>12}", row["effect"].get<std::string>(),
            row["strength"].is_number()
                ? fmt::format("{:.3g} {}", row["strength"].get<double>(), row["unit"].get<std::string>())
                : "-");
        for (const json& curve : row["curves"]) {
            const std::string text = fmt::format("{:+.0f}", 100 * curve["largest"].get<double>());
            out += fmt::format(" {:>7}", curve["certain"].get<bool>() ? text : "(" + text + ")");
        }
        out += "\n";
    }
    out += "\n";
    int k = 0;
    for (const json& curve : rows.front()["curves"])
        out += fmt::format("({}) {} of {}\n", ++k, curve["channel"].get<std::string>(),
                           curve["file"].get<std::string>());
    return out;
}

}  // namespace

int bench_atlas(const Settings& given) {
    const RunFolder folder(given);
    RunLog log(folder.file("log.txt"));
    const Settings settings = model_of(given);
    const lab_data::Sample sample = atlas_tests();
    json rows = json::array();
    for (const char* rotation : {"free", "blocked"}) {
        Settings base_settings = settings;
        base_settings.rotation = rotation;
        const std::filesystem::path place = folder.path() / rotation;
        std::filesystem::create_directories(place);
        Campaign base(base_settings, sample, place, &log);
        const std::vector<RunRecord> runs =
            direct_runs(base, base.space().values, 0, packings, fmt::format("rotation {}: ", rotation));
        for (const ModelEffect* effect : candidates_for(base_settings, base)) {
            // Freed rotation alone starts from the model that blocks it.
            if ((effect->origin == EffectOrigin::rotation) != (base_settings.rotation == "blocked")) continue;
            rows.push_back(row_of(*effect, base_settings, base, runs, sample, place, log));
        }
    }
    json document{
        {"verb", "bench atlas"},
        {"name", "a dense sand"},
        {"description",
         "Spheres by the law linear-damped, dense: what each effect of the library adds to the curves."},
        {"verdict", fmt::format("{} effects, each by {} direct DEM runs beside the same packings "
                                "without it.",
                                rows.size(), packings)},
        {"atlas", rows},
        {"settings", to_toml(settings)}};
    write_file_atomically(folder.file("report.json"), document.dump() + "\n");
    write_file_atomically(folder.file("report.html"), report_html(document));
    if (given.json)
        fmt::print("{}\n", rows.dump(1));
    else
        fmt::print("{}report: {}\n", to_text(rows), folder.file("report.html").string());
    return 0;
}

}  // namespace loam::experiments
