// The triaxial test of a sample: from the readings of lab_data::Test to the virtual test and back.
#include <algorithm>
#include <cmath>

#include "experiments/lab_tests/measured.hpp"
#include "experiments/lab_tests/triaxial.hpp"

namespace loam::experiments {
namespace {

constexpr std::size_t most_readings = 16;
constexpr double largest_strain = 0.5;  // beyond it the cell gets too flat
// A specimen that yields at constant stress follows a faster rate than one that is confined: at three times
// the oedometer's inertial number the deviatoric stress is 0.2 % (rotations blocked) to 1 % (free) above that
// at half of it.
constexpr double inertial_number_factor = 3;

/// The readings at rising, positive axial strain, in their order.
std::vector<std::size_t> rising_readings(const std::vector<double>& strain) {
    std::vector<std::size_t> out;
    double highest = 0;
    for (std::size_t k = 0; k < strain.size(); ++k) {
        if (strain[k] <= highest || strain[k] > largest_strain) continue;
        highest = strain[k];
        out.push_back(k);
    }
    return out;
}

TriaxialOptions triaxial_options(const Settings& settings, const lab_data::Test& test) {
    TriaxialOptions options;
    options.cell_pressure = test.cell_pressure;
    const double haste = settings.engine.haste;
    // Beyond the highest one the servo cannot hold the lateral stress within 1 %.
    options.inertial_number = std::min(inertial_number_factor * haste * settings.engine.inertial_number,
                                       options.highest_inertial_number);
    options.stress_change *= haste;
    options.strain_per_step *= haste;
    options.least_strain_per_step *= haste;
    if (settings.packing.empty()) options.seating_stiffness = seating_stiffness_of_made_packings;
    for (const std::size_t k : triaxial_readings(test))
        options.strains.push_back(test.column("axial_strain")[k]);
    return options;
}

}  // namespace

std::vector<std::size_t> triaxial_readings(const lab_data::Test& test) {
    const std::vector<double>&strain = test.column("axial_strain"),
          &stress = test.column("deviatoric_stress");
    const std::vector<std::size_t> rising = rising_readings(strain);
    if (rising.size() <= most_readings) return rising;
    // Evenly over the root of strain: close together where the curve bends, with the peak among them.
    const double last = std::sqrt(strain[rising.back()]);
    std::vector<std::size_t> used{
        *std::ranges::max_element(rising, {}, [&](std::size_t k) { return stress[k]; })};
    for (std::size_t n = 1; n < most_readings; ++n) {
        const double want = last * static_cast<double>(n) / static_cast<double>(most_readings - 1);
        used.push_back(*std::ranges::min_element(
            rising, {}, [&](std::size_t k) { return std::abs(std::sqrt(strain[k]) - want); }));
    }
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

VirtualTestResult run_measured_triaxial(const engine::Packing& packing, const engine::ContactLaw& law,
                                        const Settings& settings, double grain_density,
                                        const lab_data::Test& test, const std::function<bool()>& cancelled) {
    engine::Simulation simulation(packing, law, simulation_options(settings, grain_density, true));
    const TriaxialResult run = run_triaxial(simulation, law, triaxial_options(settings, test), cancelled);
    VirtualTestResult result;
    result.ok = run.complete;
    result.reason = run.reason;
    const auto n = static_cast<Eigen::Index>(run.readings.size());
    if (run.complete) result.outputs.resize(2 * n);
    for (Eigen::Index k = 0; run.complete && k < n; ++k) {
        result.outputs[k] = run.readings[static_cast<std::size_t>(k)].deviatoric_stress;
        result.outputs[n + k] = run.readings[static_cast<std::size_t>(k)].volumetric_strain;
    }
    result.inertial_number = run.largest_inertial_number;
    result.unbalanced_ratio = run.mean_unbalanced_ratio;
    result.servo_error = std::max(run.consolidation_error, run.mean_lateral_error);
    result.overlap = run.largest_overlap;
    result.energy_error = run.energy_error;
    result.steps = static_cast<double>(run.steps);
    result.seated_porosity = run.consolidated_porosity;
    return result;
}

PictureOfTest picture_of_triaxial(const engine::Packing& packing, const engine::ContactLaw& law,
                                  const Settings& settings, double grain_density,
                                  const lab_data::Test& test) {
    TriaxialOptions options = triaxial_options(settings, test);
    const std::vector<double>& stress = test.column("deviatoric_stress");
    const auto used = triaxial_readings(test);
    const std::size_t peak = *std::ranges::max_element(used, {}, [&](std::size_t k) { return stress[k]; });
    options.strains = {test.column("axial_strain")[peak]};
    engine::Simulation simulation(packing, law, simulation_options(settings, grain_density, false));
    run_triaxial(simulation, law, options);
    return {simulation.packing(), simulation.contacts(), simulation.measured().stress(2, 2)};
}

}  // namespace loam::experiments
