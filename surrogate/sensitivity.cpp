#include "surrogate/sensitivity.hpp"

#include <stdexcept>
#include <string>

#include "surrogate/designs.hpp"

namespace loam::surrogate {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Model = std::function<VectorXd(const VectorXd&)>;

// Outputs [m x n] at the points' rows [n x d].
MatrixXd run(const Model& model, const MatrixXd& points) {
    const VectorXd first = model(points.row(0).transpose());
    MatrixXd outputs(first.size(), points.rows());
    outputs.col(0) = first;
    for (Index i = 1; i < points.rows(); ++i) outputs.col(i) = model(points.row(i).transpose());
    return outputs;
}

}  // namespace

void SensitivityOptions::validate() const {
    if (samples < 16)
        throw std::invalid_argument("sensitivity: samples = " + std::to_string(samples) +
                                    ", but it must be at least 16");
}

Sensitivity sobol_indices(const Model& model, std::span<const Prior> priors,
                          const SensitivityOptions& options) {
    options.validate();
    if (priors.empty()) throw std::invalid_argument("sensitivity: at least one prior is needed");
    for (const Prior& prior : priors) prior.validate();
    const Index d = static_cast<Index>(priors.size()), n = options.samples;
    MatrixXd points = sobol_sequence(n, 2 * d, {.seed = options.seed});
    for (Index c = 0; c < 2 * d; ++c) {
        const Prior& prior = priors[static_cast<std::size_t>(c % d)];
        points.col(c) = points.col(c).unaryExpr([&](double u) { return prior.quantile_unit(u); }).eval();
    }
    const MatrixXd a = points.leftCols(d), b = points.rightCols(d);
    MatrixXd at_a = run(model, a), at_b = run(model, b);

    Sensitivity result;
    result.mean = 0.5 * (at_a.rowwise().mean() + at_b.rowwise().mean());
    // About the mean both estimators have far less scatter.
    at_a.colwise() -= result.mean;
    at_b.colwise() -= result.mean;
    result.variance = 0.5 * (at_a.cwiseAbs2().rowwise().mean() + at_b.cwiseAbs2().rowwise().mean());
    const VectorXd scale = (result.variance.array() > 0).select(result.variance.cwiseInverse(), 0.0);
    result.first.resize(result.mean.size(), d);
    result.total.resize(result.mean.size(), d);
    for (Index k = 0; k < d; ++k) {
        MatrixXd mixed = a;
        mixed.col(k) = b.col(k);
        const MatrixXd at_mixed = run(model, mixed).colwise() - result.mean;
        result.first.col(k) = at_b.cwiseProduct(at_mixed - at_a).rowwise().mean().cwiseProduct(scale);
        result.total.col(k) = 0.5 * (at_a - at_mixed).cwiseAbs2().rowwise().mean().cwiseProduct(scale);
    }
    result.evaluations = static_cast<int>(n * (d + 2));
    return result;
}

}  // namespace loam::surrogate
