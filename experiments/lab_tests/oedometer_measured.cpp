// The oedometer of a sample: from the readings of lab_data::Test to the stages of the virtual test and back.
#include <algorithm>
#include <cmath>

#include "experiments/lab_tests/measured.hpp"
#include "experiments/lab_tests/oedometer.hpp"
#include "experiments/preparation_stiffness.hpp"

namespace loam::experiments {
namespace {

constexpr std::size_t readings_per_phase = 40;

/// Thins one phase to at most readings_per_phase, spread over log stress, its last reading kept.
void append_phase(const std::vector<double>& stress, std::size_t begin, std::size_t end,
                  std::vector<std::size_t>& out) {
    if (end - begin <= readings_per_phase) {
        for (std::size_t k = begin; k < end; ++k) out.push_back(k);
        return;
    }
    const double first = std::log(stress[begin]), last = std::log(stress[end - 1]);
    std::size_t k = begin;
    for (std::size_t n = 0; n < readings_per_phase; ++n) {
        const double want = first + (last - first) * static_cast<double>(n) / (readings_per_phase - 1);
        while (k + 1 < end && (std::log(stress[k]) - want) * (last - first) < 0) ++k;
        if (out.empty() || out.back() != k || n == 0) out.push_back(k);
    }
}

OedometerOptions oedometer_options(const Settings& settings, const lab_data::Test& test) {
    OedometerOptions options;
    options.seating_stress = lab_data::seating_stress(test);
    options.isotropic_stress =
        std::min(1000 * settings.specimen.preparation_stress_kPa, options.seating_stress);
    const double haste = settings.engine.haste;
    options.inertial_number = options.hold.inertial_number = haste * settings.engine.inertial_number;
    options.stress_change *= haste;
    options.strain_per_step *= haste;
    options.least_strain_per_step *= haste;
    if (settings.packing.empty()) options.seating_stiffness = preparation_stiffness;
    for (const std::size_t k : oedometer_readings(test))
        options.stages.push_back(test.column("axial_stress")[k]);
    return options;
}

}  // namespace

std::vector<std::size_t> oedometer_readings(const lab_data::Test& test) {
    const std::vector<double>& stress = test.column("axial_stress");
    const double seat = lab_data::seating_stress(test);
    std::vector<std::size_t> used;
    std::size_t begin = 0;
    while (begin < test.size()) {
        std::size_t end = begin + 1;
        while (end < test.size() && (test.phase.empty() || test.phase[end] == test.phase[begin])) ++end;
        std::size_t from = begin;
        // Loading up to the seating stress is before the test begins.
        if (begin == 0)
            while (from < end && stress[from] <= seat * 1.0001) ++from;
        if (from < end) append_phase(stress, from, end, used);
        begin = end;
    }
    return used;
}

VirtualTestResult run_measured_oedometer(const Specimen& specimen, const engine::ContactLaw& law,
                                         const Settings& settings, double grain_density,
                                         const lab_data::Test& test, const std::function<bool()>& cancelled) {
    engine::Simulation simulation(specimen.packing, law, simulation_options(settings, grain_density, true));
    const OedometerResult run = run_oedometer(simulation, law, oedometer_options(settings, test), cancelled);
    VirtualTestResult result;
    result.ok = run.complete;
    result.reason = run.reason;
    result.outputs = run.strain;
    result.stopped_early = !run.complete;
    result.inertial_number = run.largest_inertial_number;
    result.unbalanced_ratio = run.mean_unbalanced_ratio;
    result.servo_error = run.seating_error;
    result.overlap = run.largest_overlap;
    result.energy_error = run.energy_error;
    result.steps = static_cast<double>(run.steps);
    result.seated_porosity = run.seated_porosity;
    return result;
}

PictureOfTest picture_of_oedometer(const Specimen& specimen, const engine::ContactLaw& law,
                                   const Settings& settings, double grain_density,
                                   const lab_data::Test& test) {
    OedometerOptions options = oedometer_options(settings, test);
    const double highest = *std::ranges::max_element(options.stages);
    options.stages = {highest};
    engine::Simulation simulation(specimen.packing, law, simulation_options(settings, grain_density, false));
    run_oedometer(simulation, law, options);
    return {simulation.packing(), simulation.contacts(), simulation.measured().stress(2, 2)};
}

}  // namespace loam::experiments
