// loam bench joint-twins: soils of known stiffness, stiffness ratio, friction and rolling friction, each
// tested by oedometer, triaxial and direct shear with measurement noise, on twice as many particles and other
// packings than the ensemble's; fitted jointly through one ensemble: a first design over the prior, then some
// runs where each soil's posterior lies. Beside it stands what the oedometer alone tells.
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

constexpr Index soils = 24;
constexpr int more_particles = 2, first_runs = 160, runs_per_soil = 6, packing_pool = 128;
constexpr std::uint64_t likely_from = 2'000'000, twins_from = 4'000'000;
constexpr std::uint64_t twin_packings = 21, twin_noise = 22, twin_design = 23, training_packings = 1;

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
Settings model_of(const Settings& given) {
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
    settings.calibration.specimen_particles = more_particles * settings.particles;
    if (settings.runs == Settings{}.runs) settings.runs = first_runs;
    return settings;
}

struct Soil {
    const RunRecord* truth;
    Observation joint, oedometer;
    std::optional<Fit> fit, by_oedometer;
};

Fit fit_to(const Observation& observation, const std::vector<Index>& columns,
           const std::vector<RunRecord>& runs, const Campaign& campaign) {
    Settings settings = campaign.settings();
    settings.jobs = 1;  // the soils are fitted side by side
    return fit(train_emulator(runs, campaign.space(), columns, transforms_of(observation), settings),
               campaign.space(), observation, settings);
}

void fit_jointly(std::vector<Soil>& of, const std::vector<Index>& columns, const std::vector<RunRecord>& runs,
                 const Campaign& campaign) {
#pragma omp parallel for schedule(dynamic)
    for (std::size_t k = 0; k < of.size(); ++k) of[k].fit = fit_to(of[k].joint, columns, runs, campaign);
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
            const std::uint64_t at = likely_from + specs.size();
            specs.push_back({at, "training", space.physical(x),
                             run_seed(campaign.settings().seed, at % packing_pool, training_packings),
                             static_cast<std::uint32_t>(campaign.settings().particles)});
        }
    return specs;
}

std::vector<RunRecord> twins_of(Campaign& campaign) {
    const ParameterSpace& space = campaign.space();
    const Settings& settings = campaign.settings();
    MatrixXd u =
        surrogate::maximin_latin_hypercube(soils, space.dimension(), run_seed(settings.seed, 0, twin_design));
    const MatrixXd x = space.from_probabilities((0.1 + 0.8 * u.array()).matrix());
    std::vector<RunSpec> specs;
    for (Index k = 0; k < soils; ++k) {
        const std::uint64_t index = twins_from + static_cast<std::uint64_t>(k);
        specs.push_back({index, "twin", space.physical(x.row(k).transpose()),
                         run_seed(settings.seed, index, twin_packings),
                         static_cast<std::uint32_t>(more_particles * settings.particles)});
    }
    return campaign.run("twins", specs);
}

struct Row {
    std::string name;
    bool relative = false;
    std::vector<double> errors;
    double covered = 0, identified = 0, by_oedometer = 0;  // soils
};

std::vector<Row> compare(const std::vector<Soil>& of, const Campaign& campaign) {
    const ParameterSpace& space = campaign.space();
    std::vector<Row> rows;
    for (Index d = 0; d < space.dimension(); ++d) {
        const auto p = static_cast<Index>(space.fitted[static_cast<std::size_t>(d)]);
        Row row{std::string(space.info(d).name), space.is_logarithmic(d), {}};
        for (const Soil& soil : of) {
            const double truth = soil.truth->spec.parameters[p];
            const ParameterSummary s = summarise(campaign, *soil.fit)[static_cast<std::size_t>(p)];
            row.errors.push_back(row.relative ? std::abs(s.estimate / truth - 1)
                                              : std::abs(s.estimate - truth));
            row.covered += truth >= s.q05 && truth <= s.q95 ? 1 : 0;
            row.identified += s.identified ? 1 : 0;
            row.by_oedometer +=
                summarise(campaign, *soil.by_oedometer)[static_cast<std::size_t>(p)].identified ? 1 : 0;
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace

int bench_joint_twins(const Settings& given) {
    const Settings settings = model_of(given);
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
        of.push_back({&twin, observed(joint, columns, twin, seed),
                      observed(single, oedometer_columns, twin, seed), std::nullopt, std::nullopt});
    }
    fit_jointly(of, columns, runs, campaign);
    for (RunRecord& run : campaign.run("likely runs", likely_runs(of, campaign)))
        runs.push_back(std::move(run));
    fit_jointly(of, columns, runs, campaign);
#pragma omp parallel for schedule(dynamic)
    for (std::size_t k = 0; k < of.size(); ++k)
        of[k].by_oedometer = fit_to(of[k].oedometer, oedometer_columns, runs, campaign);

    nlohmann::json result = {
        {"soils", of.size()}, {"soils_failed", twins.size() - of.size()}, {"training_runs", runs.size()}};
    std::string text = fmt::format("{:<18} {:>14} {:>16} {:>16} {:>26}\n", "parameter", "median error",
                                   "90 % covers (%)", "identified (%)", "by the oedometer alone (%)");
    const double n = static_cast<double>(of.size());
    for (const Row& row : compare(of, campaign)) {
        result["parameters"][row.name] = {{"median_error", quantile(row.errors, 0.5)},
                                          {"relative", row.relative},
                                          {"coverage90", row.covered / n},
                                          {"identified", row.identified / n},
                                          {"identified_by_oedometer", row.by_oedometer / n}};
        text += fmt::format("{:<18} {:>12.3f}{:<2} {:>16.1f} {:>16.1f} {:>26.1f}\n", row.name,
                            quantile(row.errors, 0.5), row.relative ? " *" : "", 100 * row.covered / n,
                            100 * row.identified / n, 100 * row.by_oedometer / n);
    }
    text += fmt::format("* relative. {} soils ({} more could not be tested), {} training runs\n", of.size(),
                        twins.size() - of.size(), runs.size());
    fmt::print("{}", settings.json ? result.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
