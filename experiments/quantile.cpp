#include "experiments/quantile.hpp"

#include <algorithm>
#include <stdexcept>

namespace loam::experiments {

double quantile(std::vector<double> values, double q) {
    if (values.empty()) throw std::invalid_argument("quantile: no values");
    std::ranges::sort(values);
    const double at = q * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(at);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

}  // namespace loam::experiments
