// loam bench: benchmarks, one file each under experiments/workflows/benchmarks/.
#pragma once

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// Runs the benchmark that settings.benchmark names. Returns 0. Throws UserError for an unknown name.
int run_bench(const Settings& settings);

}  // namespace loam::experiments
