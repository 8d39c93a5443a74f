// What all virtual tests of a measured sample have in common.
#pragma once

#include "engine/simulation.hpp"
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

}  // namespace loam::experiments
