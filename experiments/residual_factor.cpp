#include "experiments/residual_factor.hpp"

#include <Eigen/Cholesky>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ResidualFactor::ResidualFactor(const MatrixXd& loadings, const VectorXd& variance, const VectorXd& residuals)
    : loadings_(loadings),
      residuals_(residuals),
      root_(variance.cwiseMax(0.0).cwiseSqrt()),
      gram_(MatrixXd::Identity(loadings.cols(), loadings.cols())),
      projected_(VectorXd::Zero(loadings.cols())) {}

bool ResidualFactor::add(Stretch at, MatrixXd& block) {
    const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(block);
    if (factor.info() != Eigen::Success) return false;
    const Index q = loadings_.cols();
    white_.resize(at.count, q + 1);
    white_.leftCols(q) = loadings_.middleRows(at.first, at.count) * root_.asDiagonal();
    white_.col(q) = residuals_.segment(at.first, at.count);
    factor.matrixL().solveInPlace(white_);
    log_det_ += 2 * block.diagonal().array().log().sum();
    squares_ += white_.col(q).squaredNorm();
    gram_.selfadjointView<Eigen::Lower>().rankUpdate(white_.leftCols(q).transpose());
    projected_ += white_.leftCols(q).transpose() * white_.col(q);
    return true;
}

std::optional<double> ResidualFactor::log_density() const {
    // C^-1 = B^-1 - B^-1 W (I + W' B^-1 W)^-1 W' B^-1 (Woodbury), and det C = det B det(I + W' B^-1 W).
    const Eigen::LLT<MatrixXd> inner(gram_);
    if (inner.info() != Eigen::Success) return std::nullopt;
    const double log_det = log_det_ + 2 * inner.matrixLLT().diagonal().array().log().sum();
    return -0.5 * (log_det + squares_ - inner.matrixL().solve(projected_).squaredNorm());
}

double ResidualFactor::expected_log_density() const {
    const double open = gram_.trace() - static_cast<double>(gram_.rows());
    return -0.5 * (log_det_ + squares_ + open);
}

}  // namespace loam::experiments
