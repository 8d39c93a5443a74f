// loam bulk: calibrates every sample of a data set from one shared ensemble.
#pragma once

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

int run_bulk(const Settings& settings);

}  // namespace loam::experiments
