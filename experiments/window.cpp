#include "experiments/window.hpp"

#include <algorithm>
#include <vector>

#include "experiments/quantile.hpp"

namespace loam::experiments {

using Eigen::Index;
using Eigen::VectorXd;

Window window_about(const Eigen::MatrixXd& draws) {
    constexpr double left_out = 1e-3, wider = 0.5, margin = 0.03;
    Window out{VectorXd(draws.cols()), VectorXd(draws.cols())};
    for (Index k = 0; k < draws.cols(); ++k) {
        const VectorXd column = draws.col(k);
        const std::vector<double> values(column.begin(), column.end());
        const double low = quantile(values, left_out), high = quantile(values, 1 - left_out);
        const double by = wider * (high - low) + margin;
        out.lower[k] = std::clamp(low - by, 0.0, 1.0 - margin);
        out.upper[k] = std::clamp(high + by, margin, 1.0);
    }
    return out;
}

Window hull(const Window& a, const Window& b) {
    return {a.lower.cwiseMin(b.lower), a.upper.cwiseMax(b.upper)};
}

}  // namespace loam::experiments
