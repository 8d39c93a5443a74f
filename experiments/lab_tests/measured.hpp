// What all virtual tests of a measured sample have in common.
#pragma once

#include "engine/simulation.hpp"
#include "experiments/lab_tests/registry.hpp"
#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// How the engine simulates a test under these settings; grain density in kg/m³.
inline engine::SimulationOptions simulation_options(const Settings& settings, double grain_density,
                                                    bool energy_balance) {
    engine::SimulationOptions how;
    how.free_rotation = settings.rotation == "free";
    how.damping = settings.engine.damping;
    how.grain_density = grain_density;
    how.density_scaling = settings.engine.density_scaling;
    how.time_step_safety = settings.engine.time_step_safety;
    how.energy_balance = energy_balance;
    return how;
}

// A specimen that yields at constant stress follows a faster rate than one that is confined: at three times
// the oedometer's inertial number the deviatoric stress is 0.2 % (rotations blocked) to 1 % (free) above that
// at half of it.
inline constexpr double yielding_inertial_number_factor = 3;

/// What a triaxial or direct shear run comes to, with the two channels of each of its readings.
template <class Run, class First, class Second>
VirtualTestResult result_of(const Run& run, double servo_error, double porosity, First first, Second second) {
    VirtualTestResult out;
    out.ok = run.complete;
    out.reason = run.reason;
    const auto n = static_cast<Eigen::Index>(run.readings.size());
    if (run.complete) out.outputs.resize(2 * n);
    for (Eigen::Index k = 0; run.complete && k < n; ++k) {
        out.outputs[k] = first(run.readings[static_cast<std::size_t>(k)]);
        out.outputs[n + k] = second(run.readings[static_cast<std::size_t>(k)]);
    }
    out.inertial_number = run.largest_inertial_number;
    out.unbalanced_ratio = run.mean_unbalanced_ratio;
    out.servo_error = servo_error;
    out.overlap = run.largest_overlap;
    out.energy_error = run.energy_error;
    out.steps = static_cast<double>(run.steps);
    out.seated_porosity = porosity;
    return out;
}

}  // namespace loam::experiments
