#include "experiments/feasibility.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double ridge = 0.05;  // precision of the weights: they may be some tens, since the cube's side is 1
constexpr int most_passes = 50;

VectorXd features(const VectorXd& x) {
    const Index d = x.size();
    VectorXd out(1 + d + d * (d + 1) / 2);
    out[0] = 1;
    Index at = 1;
    for (Index i = 0; i < d; ++i) out[at++] = x[i] - 0.5;
    for (Index i = 0; i < d; ++i)
        for (Index j = i; j < d; ++j) out[at++] = (x[i] - 0.5) * (x[j] - 0.5);
    return out;
}

double log_logistic(double z) {
    return z > 0 ? -std::log1p(std::exp(-z)) : z - std::log1p(std::exp(z));
}

}  // namespace

Feasibility::Feasibility(const MatrixXd& x, const std::vector<bool>& success) {
    const auto good = std::ranges::count(success, true);
    if (good == 0 || good == static_cast<std::ptrdiff_t>(success.size())) return;
    const Index n = x.rows(), f = features(x.row(0).transpose()).size();
    MatrixXd phi(n, f);
    VectorXd y(n);
    for (Index k = 0; k < n; ++k) {
        phi.row(k) = features(x.row(k).transpose()).transpose();
        y[k] = success[static_cast<std::size_t>(k)] ? 1 : 0;
    }
    // Newton's method; the ridge keeps the problem strictly concave.
    weights_ = VectorXd::Zero(f);
    for (int pass = 0; pass < most_passes; ++pass) {
        const VectorXd p = (1 + (-(phi * weights_)).array().exp()).inverse().matrix();
        const VectorXd gradient = phi.transpose() * (y - p) - ridge * weights_;
        MatrixXd curvature = phi.transpose() * (p.array() * (1 - p.array())).matrix().asDiagonal() * phi;
        curvature.diagonal().array() += ridge;
        VectorXd step = curvature.llt().solve(gradient);
        step *= std::min(1.0, 5 / std::max(1e-12, step.cwiseAbs().maxCoeff()));
        weights_ += step;
        if (step.cwiseAbs().maxCoeff() < 1e-8) break;
    }
}

double Feasibility::log_success(const VectorXd& x) const {
    return weights_.size() == 0 ? 0.0 : log_logistic(features(x).dot(weights_));
}

}  // namespace loam::experiments
