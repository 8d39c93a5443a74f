#include "experiments/bulk/precompression.hpp"

#include <Eigen/QR>
#include <cmath>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::optional<double> precompression_stress(const VectorXd& stress, const VectorXd& strain) {
    constexpr Index fewest = 4, added = 2, degree = 4, grid = 1000;
    const Index n = stress.size();
    if (n < fewest) return std::nullopt;
    const VectorXd log = stress.array().log();
    const double first = log[0], width = log[n - 1] - first, step = width / static_cast<double>(n - 1);
    VectorXd x(n + 2 * added), y(n + 2 * added);
    x.segment(added, n) = log;
    y.segment(added, n) = strain;
    const double low = (strain[1] - strain[0]) / (log[1] - log[0]),
                 high = (strain[n - 1] - strain[n - 2]) / (log[n - 1] - log[n - 2]);
    for (Index k = 1; k <= added; ++k) {
        const double off = step * static_cast<double>(k);
        x[added - k] = log[0] - off;
        y[added - k] = strain[0] - low * off;
        x[added + n - 1 + k] = log[n - 1] + off;
        y[added + n - 1 + k] = strain[n - 1] + high * off;
    }
    MatrixXd powers(x.size(), degree + 1);
    const VectorXd u = (x.array() - first) / width;  // 0..1 over the readings: well conditioned
    for (Index p = 0; p <= degree; ++p) powers.col(p) = u.array().pow(static_cast<double>(p));
    const VectorXd c = powers.householderQr().solve(y);
    double best = -INFINITY, at = 0;
    for (Index k = 0; k <= grid; ++k) {
        const double v = static_cast<double>(k) / grid;
        const double slope = c[1] + v * (2 * c[2] + v * (3 * c[3] + v * 4 * c[4]));
        if (slope <= best) continue;
        best = slope;
        at = v;
    }
    return std::exp(first + at * width);
}

}  // namespace loam::experiments
