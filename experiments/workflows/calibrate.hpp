// loam calibrate: fit one sample's contact parameters to its measured curves.
#pragma once

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// Writes config.toml, ensemble.h5, result.json, report.json, report.html and log.txt into settings.out and
/// prints a short table. Returns 0. Throws UserError, Interrupted, std::runtime_error.
int run_calibrate(const Settings& settings);

}  // namespace loam::experiments
