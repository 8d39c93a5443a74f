// loam bench joint-twins: soils of known stiffness, stiffness ratio, friction and rolling friction, each
// tested by oedometer, triaxial and direct shear with measurement noise, on twice as many particles and other
// packings than the ensemble's; fitted jointly through one ensemble: a first design over the prior, then some
// runs where each soil's posterior lies. Beside it stands what the oedometer alone tells, and what as many
// runs tell that are all spread over the prior.
#include <fmt/format.h>
#include <omp.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "experiments/calibration.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/quantile.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/twin_tests.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of 24 soils, the share that sound 90 % intervals cover leaves 80 to 98 % one time in six; of 48 in forty.
constexpr Index joint_soils = 48;
constexpr int joint_twin_enlargement = 2, first_runs = 160, runs_per_soil = 3, packing_pool = 128;
constexpr std::uint64_t likely_from = 2'000'000, spread_from = 3'000'000;
constexpr std::uint64_t training_packings = 1;  // of run_seed

/// One test of each kind, without measurements.
lab_data::Sample three_tests() {
    lab_data::Sample sample = reference_sample();
    sample.name = "joint twins";
    lab_data::Test triaxial =
        test_without_readings(lab_data::TestKind::triaxial, "triaxial.csv", "axial_strain", 0.15, 14,
                              {"deviatoric_stress", "volumetric_strain"});
    triaxial.cell_pressure = 100e3;
    lab_data::Test shear =
        test_without_readings(lab_data::TestKind::direct_shear, "direct_shear.csv", "shear_displacement",
                              0.006, 14, {"shear_stress", "settlement"});
    shear.normal_stress = 100e3;
    shear.box_length = shear.box_width = 0.06;
    shear.box_height = 0.03;
    sample.tests.push_back(std::move(triaxial));
    sample.tests.push_back(std::move(shear));
    for (lab_data::Test& test : sample.tests) test.initial_void_ratio = 0.68;
    return sample;
}

/// The model that is fitted, whatever the command line says of it.
Settings joint_model_of(const Settings& given) {
    using engine::PriorKind;
    Settings settings = given;
    settings.law = "linear-damped";
    settings.rotation = "free";
    settings.effects = {"rolling_resistance"};
    settings.set = {{"normal_damping", 0.1}, {"tangential_damping", 0.1}, {"rolling_stiffness", 2.0}};
    settings.priors = {{"young_modulus", {PriorKind::loguniform, 0, 0, 5e7, 1e9}},
                       {"stiffness_ratio", {PriorKind::uniform, 0, 0, 0.1, 1.0}},
                       {"friction_angle", {PriorKind::uniform, 0, 0, 0.1, 0.6}},
                       {"rolling_friction", {PriorKind::uniform, 0, 0, 0, 0.3}}};
    settings.calibration.specimen_particles = joint_twin_enlargement * settings.particles;
    if (settings.runs == Settings{}.runs) settings.runs = first_runs;
    return settings;
}

struct Soil {
    const RunRecord* truth;
    Observation joint, oedometer;
    std::optional<Fit> fit, by_oedometer, by_spread_runs;
};

Fit fit_to(const Observation& observation, const std::vector<Index>& columns,
           const std::vector<RunRecord>& runs, const Campaign& campaign) {
    Settings settings = campaign.settings();
    settings.jobs = 1;  // the soils are fitted side by side
    return fit(train_emulator(runs, campaign.space(), columns, transforms_of(observation), settings),
               campaign.space(), observation, settings);
}

/// Fits every soil to that observation of it.
void fit_all(std::vector<Soil>& of, Observation Soil::*observation, std::optional<Fit> Soil::*result,
             const std::vector<Index>& columns, const std::vector<RunRecord>& runs,
             const Campaign& campaign) {
#pragma omp parallel for schedule(dynamic)
    for (std::size_t k = 0; k < of.size(); ++k)
        of[k].*result = fit_to(of[k].*observation, columns, runs, campaign);
}

RunSpec shared_run(const Campaign& campaign, std::uint64_t index, const VectorXd& x) {
    return {index, "training", campaign.space().physical(x),
            run_seed(campaign.settings().seed, index % packing_pool, training_packings),
            static_cast<std::uint32_t>(campaign.settings().particles)};
}

/// Runs where the posteriors of the soils lie.
std::vector<RunSpec> likely_runs(const std::vector<Soil>& of, const Campaign& campaign) {
    const ParameterSpace& space = campaign.space();
    std::vector<RunSpec> specs;
    for (const Soil& soil : of)
        for (int k = 0; k < runs_per_soil; ++k) {
            const MatrixXd& draws = soil.fit->posterior.draws;
            const VectorXd x =
                draws.row(k * draws.rows() / runs_per_soil).head(space.dimension()).transpose();
            specs.push_back(shared_run(campaign, likely_from + specs.size(), x));
        }
    return specs;
}

/// As many runs as a second Latin hypercube over the prior.
std::vector<RunSpec> spread_runs(std::size_t count, const Campaign& campaign) {
    const ParameterSpace& space = campaign.space();
    const MatrixXd x = space.from_probabilities(surrogate::maximin_latin_hypercube(
        static_cast<Index>(count), space.dimension(), run_seed(campaign.settings().seed, 1, twin_design)));
    std::vector<RunSpec> specs;
    for (Index k = 0; k < x.rows(); ++k)
        specs.push_back(
            shared_run(campaign, spread_from + static_cast<std::uint64_t>(k), x.row(k).transpose()));
    return specs;
}

std::vector<RunRecord> with(std::vector<RunRecord> runs, const std::vector<RunRecord>& more) {
    runs.insert(runs.end(), more.begin(), more.end());
    return runs;
}

std::vector<RunRecord> twins_of(Campaign& campaign) {
    const ParameterSpace& space = campaign.space();
    const Settings& settings = campaign.settings();
    MatrixXd u = surrogate::maximin_latin_hypercube(joint_soils, space.dimension(),
                                                    run_seed(settings.seed, 0, twin_design));
    const MatrixXd x = space.from_probabilities((0.1 + 0.8 * u.array()).matrix());
    std::vector<RunSpec> specs;
    for (Index k = 0; k < joint_soils; ++k) {
        const std::uint64_t index = twins_from + static_cast<std::uint64_t>(k);
        specs.push_back({index, "twin", space.physical(x.row(k).transpose()),
                         run_seed(settings.seed, index, twin_packings),
                         static_cast<std::uint32_t>(joint_twin_enlargement * settings.particles)});
    }
    return campaign.run("twins", specs);
}

struct Row {
    std::string name;
    bool relative = false;
    std::vector<double> errors, widths;  // widths: of the 90 % intervals, relative like the errors
    double covered = 0, identified = 0;  // soils
};

std::vector<Row> rows_of(const std::vector<Soil>& of, std::optional<Fit> Soil::*by,
                         const Campaign& campaign) {
    const ParameterSpace& space = campaign.space();
    std::vector<Row> rows;
    for (Index d = 0; d < space.dimension(); ++d) {
        const auto p = static_cast<Index>(space.fitted[static_cast<std::size_t>(d)]);
        Row row{std::string(space.info(d).name), space.is_logarithmic(d), {}, {}};
        for (const Soil& soil : of) {
            const double truth = soil.truth->spec.parameters[p], unit = row.relative ? truth : 1.0;
            const ParameterSummary s = summarise(campaign, *(soil.*by))[static_cast<std::size_t>(p)];
            row.errors.push_back(std::abs(s.estimate - truth) / unit);
            row.widths.push_back((s.q95 - s.q05) / unit);
            row.covered += truth >= s.q05 && truth <= s.q95 ? 1 : 0;
            row.identified += s.identified ? 1 : 0;
        }
        row.covered /= static_cast<double>(of.size());
        row.identified /= static_cast<double>(of.size());
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace

int bench_joint_twins(const Settings& given) {
    const Settings settings = joint_model_of(given);
    const lab_data::Sample sample = three_tests();
    const RunFolder folder(given);
    RunLog log(folder.file("log.txt"));
    Campaign campaign(settings, sample, folder.path(), &log);
    std::vector<Index> columns, oedometer_columns;
    const Observation joint = observation_of(campaign, columns);
    const lab_data::TestKind oedometer = lab_data::TestKind::oedometer;
    const Observation single = observation_of(campaign, oedometer_columns, {&oedometer, 1});

    std::vector<RunRecord> runs = training_runs(campaign);
    const std::vector<RunRecord> twins = twins_of(campaign);
    std::vector<Soil> of;
    for (const RunRecord& twin : twins) {
        if (!twin.ok) continue;
        const std::uint64_t seed = run_seed(settings.seed, twin.spec.index, twin_noise);
        of.push_back({&twin,
                      observed(joint, columns, twin, seed),
                      observed(single, oedometer_columns, twin, seed),
                      {},
                      {},
                      {}});
    }
    fit_all(of, &Soil::joint, &Soil::fit, columns, runs, campaign);
    const std::vector<RunRecord> likely = campaign.run("likely runs", likely_runs(of, campaign)),
                                 spread = campaign.run("spread runs", spread_runs(likely.size(), campaign));
    fit_all(of, &Soil::joint, &Soil::by_spread_runs, columns, with(runs, spread), campaign);
    runs = with(std::move(runs), likely);
    fit_all(of, &Soil::joint, &Soil::fit, columns, runs, campaign);
    fit_all(of, &Soil::oedometer, &Soil::by_oedometer, oedometer_columns, runs, campaign);

    nlohmann::json result = {
        {"soils", of.size()}, {"soils_failed", twins.size() - of.size()}, {"training_runs", runs.size()}};
    std::string text = fmt::format("{:<18} {:<21} {:>14} {:>14} {:>16} {:>16}\n", "parameter", "by",
                                   "median error", "median width", "90 % covers (%)", "identified (%)");
    const std::vector<Row> rows = rows_of(of, &Soil::fit, campaign),
                           oedometers = rows_of(of, &Soil::by_oedometer, campaign),
                           spreads = rows_of(of, &Soil::by_spread_runs, campaign);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Row& row = rows[k];
        result["parameters"][row.name] = {{"median_error", quantile(row.errors, 0.5)},
                                          {"median_width", quantile(row.widths, 0.5)},
                                          {"relative", row.relative},
                                          {"coverage90", row.covered},
                                          {"identified", row.identified},
                                          {"identified_by_oedometer", oedometers[k].identified},
                                          {"median_error_by_spread_runs", quantile(spreads[k].errors, 0.5)},
                                          {"median_width_by_spread_runs", quantile(spreads[k].widths, 0.5)}};
        for (const auto& [by, r] : {std::pair{"all tests", &row},
                                    {"all, runs spread", &spreads[k]},
                                    {"the oedometer alone", &oedometers[k]}})
            text +=
                fmt::format("{:<18} {:<21} {:>12.3f}{:<2} {:>12.3f}{:<2} {:>16.1f} {:>16.1f}\n", r->name, by,
                            quantile(r->errors, 0.5), r->relative ? " *" : "", quantile(r->widths, 0.5),
                            r->relative ? " *" : "", 100 * r->covered, 100 * r->identified);
    }
    text += fmt::format(
        "* relative. {} soils ({} more could not be tested), {} training runs, of which {} lie where the "
        "soils' posteriors do, or are spread over the prior like the others\n",
        of.size(), twins.size() - of.size(), runs.size(), likely.size());
    fmt::print("{}", settings.json ? result.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
