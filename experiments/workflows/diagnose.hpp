// loam diagnose: find where the calibrated model fails, name the missing effect, add it, show the gap shrink.
#pragma once

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// Writes config.toml, ensemble.h5 (of the base model), effects/NAME/ensemble.h5, result.json, report.json,
/// report.html and log.txt into settings.out and prints a short text. Returns 0. Throws UserError,
/// Interrupted, std::runtime_error.
int run_diagnose(const Settings& settings);

}  // namespace loam::experiments
