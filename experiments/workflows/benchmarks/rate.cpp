// loam bench rate: is the loading quasi-static? The same packings and soils at the loading rate of the
// settings and at half of it (inertial number and both limits of the rate halved together).
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/calibration.hpp"
#include "experiments/lab_tests/oedometer.hpp"
#include "experiments/preparation_stiffness.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

constexpr Eigen::Index soils_compared = 24;
constexpr std::uint64_t packings_compared = 8;

Eigen::VectorXd run_at(const engine::Packing& packing, const engine::ContactLaw& law, double factor,
                       const Settings& settings, const lab_data::Test& test) {
    engine::SimulationOptions how;
    how.damping = settings.engine.damping;
    how.density_scaling = settings.engine.density_scaling;
    how.time_step_safety = settings.engine.time_step_safety;
    OedometerOptions options;
    options.stages = test.column("axial_stress");
    options.seating_stiffness = preparation_stiffness;
    options.inertial_number = options.hold.inertial_number = factor * settings.engine.inertial_number;
    options.highest_inertial_number *= factor;
    options.strain_per_step *= factor;
    options.least_strain_per_step *= factor;
    options.stress_change *= factor;
    engine::Simulation simulation(packing, law, how);
    const StopToken stop = SignalScope::token();
    return run_oedometer(simulation, law, options,
                         [&] {
                             stop.throw_if_requested();
                             return false;
                         })
        .strain;
}

}  // namespace

int bench_rate(const Settings& settings) {
    const lab_data::Sample sample = reference_sample();
    const lab_data::Test& test = sample.tests.front();
    const ParameterSpace space = parameter_space(settings);
    // The central four fifths of the prior.
    Eigen::MatrixXd u = surrogate::sobol_sequence(soils_compared, space.dimension(), {.seed = settings.seed});
    u = (0.1 + 0.8 * u.array()).matrix();
    const Eigen::MatrixXd x = space.from_probabilities(u);
    SpecimenPool& pool = specimen_pool();
    const auto stages = static_cast<Eigen::Index>(test.size());
    Eigen::VectorXd change = Eigen::VectorXd::Zero(stages), size = change, squares = change, runs = change;
    const int total = static_cast<int>(soils_compared * static_cast<Eigen::Index>(packings_compared));
    std::vector<Eigen::VectorXd> full(static_cast<std::size_t>(total)), half = full;
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < total; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const auto specimen =
            pool.get(settings.specimen, 0.47, {static_cast<std::uint32_t>(settings.particles)},
                     1 + at % packings_compared, {});
        const engine::ContactLaw law =
            contact_law(settings, space.physical(x.row(k / static_cast<int>(packings_compared)).transpose()));
        full[at] = run_at(specimen->packing, law, 1, settings, test);
        half[at] = run_at(specimen->packing, law, 0.5, settings, test);
    }
    for (std::size_t k = 0; k < full.size(); ++k)
        for (Eigen::Index s = 0; s < stages; ++s) {
            const double d = half[k][s] - full[k][s];
            if (!std::isfinite(d)) continue;
            change[s] += d;
            size[s] += std::abs(d);
            squares[s] += d * d;
            runs[s] += 1;
        }
    nlohmann::json rows = nlohmann::json::array();
    std::string text = fmt::format(
        "{} soils, {} packings each; strain at half the rate minus strain at the full rate\n"
        "{:>12} {:>12} {:>15} {:>14} {:>6}\n",
        soils_compared, packings_compared, "stress (kPa)", "mean", "standard error", "mean absolute", "runs");
    for (Eigen::Index s = 0; s < stages; ++s) {
        const double stress = test.column("axial_stress")[static_cast<std::size_t>(s)] / 1000;
        const double mean = change[s] / runs[s];
        const double error = std::sqrt((squares[s] / runs[s] - mean * mean) / (runs[s] - 1));
        rows.push_back({{"stress_kPa", stress},
                        {"mean", mean},
                        {"standard_error", error},
                        {"mean_absolute", size[s] / runs[s]},
                        {"runs", runs[s]}});
        text += fmt::format("{:>12.0f} {:>12.2e} {:>15.1e} {:>14.2e} {:>6.0f}\n", stress, mean, error,
                            size[s] / runs[s], runs[s]);
    }
    fmt::print("{}", settings.json ? rows.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
