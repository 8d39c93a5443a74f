#pragma once

#include <vector>

namespace loam::experiments {

/// The q-quantile of the values, 0 <= q <= 1: linear interpolation of the order statistics. Throws
/// std::invalid_argument when there are none.
double quantile(std::vector<double> values, double q);

}  // namespace loam::experiments
