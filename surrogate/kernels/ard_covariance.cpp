#include "surrogate/kernels/ard_covariance.hpp"

namespace loam::surrogate {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ArdCovariance::ArdCovariance(const KernelInfo& kernel, const MatrixXd& points, double variance,
                             const VectorXd& length_scales)
    : kernel_(kernel.evaluate), variance_(variance), inverse_lengths_(length_scales.cwiseInverse()) {
    scaled_ = points * inverse_lengths_.asDiagonal();
}

void ArdCovariance::matrix(MatrixXd& value, MatrixXd& slope) const {
    const Index n = size();
    value.resize(n, n);
    slope.resize(n, n);
    ArrayXd squared(n);
    for (Index j = 0; j < n; ++j) {
        const Index rest = n - j;
        auto r2 = squared.head(rest);
        r2.setZero();
        for (Index k = 0; k < scaled_.cols(); ++k)
            r2 += (scaled_.col(k).tail(rest).array() - scaled_(j, k)).square();
        kernel_(r2, value.col(j).tail(rest).array(), slope.col(j).tail(rest).array());
        value.col(j).tail(rest) *= variance_;
        slope.col(j).tail(rest) *= variance_;
    }
}

VectorXd ArdCovariance::contract(const MatrixXd& value, const MatrixXd& slope,
                                 const MatrixXd& weights) const {
    const Index n = size(), d = scaled_.cols();
    VectorXd gradient = VectorXd::Zero(1 + d);
    ArrayXd weighted(n);
    for (Index j = 0; j < n; ++j) {
        const Index below = n - j - 1;
        const auto w = weights.col(j).tail(below).array();
        gradient(0) += weights(j, j) * value(j, j) + 2 * (w * value.col(j).tail(below).array()).sum();
        // d(r^2) / d(log length) = -2 (scaled difference)^2; each pair counts twice.
        auto s = weighted.head(below);
        s = -4 * w * slope.col(j).tail(below).array();
        for (Index k = 0; k < d; ++k)
            gradient(1 + k) += (s * (scaled_.col(k).tail(below).array() - scaled_(j, k)).square()).sum();
    }
    return gradient;
}

VectorXd ArdCovariance::vector(const Eigen::Ref<const VectorXd>& x, MatrixXd* jacobian) const {
    const Index n = size(), d = scaled_.cols();
    ArrayXd squared = ArrayXd::Zero(n), slope(n);
    VectorXd value(n);
    for (Index k = 0; k < d; ++k) squared += (scaled_.col(k).array() - x(k) * inverse_lengths_(k)).square();
    kernel_(squared, value.array(), slope);
    value *= variance_;
    if (jacobian) {
        jacobian->resize(n, d);
        slope *= -2 * variance_;
        for (Index k = 0; k < d; ++k) {
            const double scale = inverse_lengths_(k);
            jacobian->col(k) = scale * slope * (scaled_.col(k).array() - x(k) * scale);
        }
    }
    return value;
}

}  // namespace loam::surrogate
