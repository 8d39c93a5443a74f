// The verb crosstest: parameter sets from triaxial and from direct shear tests, exchanged and compared.
#pragma once

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// Fits the sample's triaxial tests, its direct shear tests, and both at once, from one ensemble; runs every
/// set on every test; says whether the two sets agree. Writes the run folder; returns the exit status. Throws
/// UserError, Interrupted, and std::runtime_error where too many runs fail.
int run_crosstest(const Settings& settings);

}  // namespace loam::experiments
