// The triaxial test of a sample: from the readings of lab_data::Test to the virtual test and back.
#include <algorithm>
#include <cmath>

#include "experiments/lab_tests/measured.hpp"
#include "experiments/lab_tests/readings.hpp"
#include "experiments/lab_tests/triaxial.hpp"
#include "experiments/preparation_stiffness.hpp"

namespace loam::experiments {
namespace {

constexpr double largest_strain = 0.5;  // beyond it the cell gets too flat

TriaxialOptions triaxial_options(const Settings& settings, const lab_data::Test& test) {
    TriaxialOptions options;
    options.cell_pressure = test.cell_pressure;
    const double haste = settings.engine.haste;
    // Beyond the highest one the servo cannot hold the lateral stress within 1 %.
    options.inertial_number =
        std::min(yielding_inertial_number_factor * haste * settings.engine.inertial_number,
                 options.highest_inertial_number);
    options.stress_change *= haste;
    options.strain_per_step *= haste;
    options.least_strain_per_step *= haste;
    if (settings.packing.empty()) options.seating_stiffness = preparation_stiffness;
    for (const std::size_t k : triaxial_readings(test))
        options.strains.push_back(test.column("axial_strain")[k]);
    return options;
}

/// Puts the walls around a specimen in a box; what they feel is then what is steered and read.
void enclose(engine::Simulation& simulation, const Specimen& specimen, TriaxialOptions& options) {
    if (!specimen.box) return;
    const engine::BoxWalls walls = engine::add_box(simulation, *specimen.box);
    options.stress_of = [walls](const engine::Simulation& s) { return engine::box_pressures(s, walls); };
}

}  // namespace

std::vector<std::size_t> triaxial_readings(const lab_data::Test& test) {
    return spread_readings(test.column("axial_strain"), test.column("deviatoric_stress"), largest_strain);
}

SpecimenShape triaxial_specimen(const Settings& settings, const lab_data::Sample&, const lab_data::Test&,
                                double, std::uint32_t particles) {
    if (settings.triaxial.boundary == "walls") return {particles, Eigen::Vector3d::Ones()};
    return {particles};
}

VirtualTestResult run_measured_triaxial(const Specimen& specimen, const engine::ContactLaw& law,
                                        const Settings& settings, double grain_density,
                                        const lab_data::Test& test, const std::function<bool()>& cancelled) {
    engine::Simulation simulation(specimen.packing, law, simulation_options(settings, grain_density, true));
    TriaxialOptions options = triaxial_options(settings, test);
    enclose(simulation, specimen, options);
    const TriaxialResult run = run_triaxial(simulation, law, options, cancelled);
    return result_of(
        run, std::max(run.consolidation_error, run.mean_lateral_error), run.consolidated_porosity,
        [](const TriaxialReading& at) { return at.deviatoric_stress; },
        [](const TriaxialReading& at) { return at.volumetric_strain; });
}

PictureOfTest picture_of_triaxial(const Specimen& specimen, const engine::ContactLaw& law,
                                  const Settings& settings, double grain_density,
                                  const lab_data::Test& test) {
    TriaxialOptions options = triaxial_options(settings, test);
    const std::vector<double>& stress = test.column("deviatoric_stress");
    const auto used = triaxial_readings(test);
    const std::size_t peak = *std::ranges::max_element(used, {}, [&](std::size_t k) { return stress[k]; });
    options.strains = {test.column("axial_strain")[peak]};
    engine::Simulation simulation(specimen.packing, law, simulation_options(settings, grain_density, false));
    enclose(simulation, specimen, options);
    run_triaxial(simulation, law, options);
    return {simulation.packing(), simulation.contacts(), simulation.measured().stress(2, 2)};
}

}  // namespace loam::experiments
