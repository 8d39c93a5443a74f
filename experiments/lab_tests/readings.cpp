#include "experiments/lab_tests/readings.hpp"

#include <algorithm>
#include <cmath>

namespace loam::experiments {
namespace {

constexpr std::size_t most_readings = 16;

std::vector<std::size_t> rising_readings(const std::vector<double>& x, double largest) {
    std::vector<std::size_t> out;
    double highest = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        if (x[k] <= highest || x[k] > largest) continue;
        highest = x[k];
        out.push_back(k);
    }
    return out;
}

}  // namespace

std::vector<std::size_t> spread_readings(const std::vector<double>& x, const std::vector<double>& peaked,
                                         double largest) {
    const std::vector<std::size_t> rising = rising_readings(x, largest);
    if (rising.size() <= most_readings) return rising;
    const double last = std::sqrt(x[rising.back()]);
    std::vector<std::size_t> used{
        *std::ranges::max_element(rising, {}, [&](std::size_t k) { return peaked[k]; })};
    for (std::size_t n = 1; n < most_readings; ++n) {
        const double want = last * static_cast<double>(n) / static_cast<double>(most_readings - 1);
        used.push_back(*std::ranges::min_element(
            rising, {}, [&](std::size_t k) { return std::abs(std::sqrt(x[k]) - want); }));
    }
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

}  // namespace loam::experiments
