// The covariance of a set of points under a kernel with one length scale for each input ("automatic relevance
// determination"): k(x, x') = variance * kernel(sum_k ((x_k - x'_k) / length_k)^2), with the derivatives that
// fitting (with respect to the logarithms of variance and lengths) and prediction (with respect to x) need.
#pragma once

#include <Eigen/Dense>

#include "surrogate/kernels/registry.hpp"

namespace loam::surrogate {

class ArdCovariance {
  public:
    /// Points [n x d], variance > 0, length_scales [d] > 0 in the points' unit.
    ArdCovariance(const KernelInfo& kernel, const Eigen::MatrixXd& points, double variance,
                  const Eigen::VectorXd& length_scales);

    Eigen::Index size() const { return scaled_.rows(); }
    double variance() const { return variance_; }

    /// Lower triangles [n x n] of the covariance and of its derivative with respect to the squared scaled
    /// distance; what lies above the diagonals is left alone.
    void matrix(Eigen::MatrixXd& value, Eigen::MatrixXd& slope) const;

    /// sum_ij W_ij dK_ij / d(log variance, log length_1, …, log length_d), [1 + d], for a symmetric W [n x n]
    /// of which the lower triangle is read; value and slope as matrix() gave them.
    Eigen::VectorXd contract(const Eigen::MatrixXd& value, const Eigen::MatrixXd& slope,
                             const Eigen::MatrixXd& weights) const;

    /// Covariance of each point with x [d], and the derivative [n x d] with respect to x if jacobian !=
    /// nullptr.
    Eigen::VectorXd vector(const Eigen::Ref<const Eigen::VectorXd>& x,
                           Eigen::MatrixXd* jacobian = nullptr) const;

  private:
    KernelFunction kernel_;
    Eigen::MatrixXd scaled_;  // the points over their length scales
    double variance_;
    Eigen::VectorXd inverse_lengths_;
};

}  // namespace loam::surrogate
