// Which readings of a measured curve are simulated.
#pragma once

#include <cstddef>
#include <vector>

namespace loam::experiments {

/// Indices of at most 16 readings, evenly spread over the root of x, so that they stand close together where
/// such curves bend, with the largest `peaked` among them. Readings where x does not rise, is not positive or
/// lies beyond `largest` are left out. Both columns [n].
std::vector<std::size_t> spread_readings(const std::vector<double>& x, const std::vector<double>& peaked,
                                         double largest);

}  // namespace loam::experiments
