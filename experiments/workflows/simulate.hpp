// loam simulate: run a sample's virtual tests forward with given parameters.
#pragma once

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// Runs the tests on the packing that the settings name, or else on several packings of the measured density,
/// whose mean is compared with the measurement. Parameters that are not set have their prior's median, and a
/// warning says so. Writes the run folder and prints a short table. Returns 0. Throws UserError, Interrupted,
/// std::runtime_error.
int run_simulate(const Settings& settings);

}  // namespace loam::experiments
