// Coordinates for curves in which they can be emulated one number at a time: outputs are divided by a metric
// (their spread, or better the covariance of their noise), then rotated to principal components. Whitened by
// the noise, the components come in the order of signal over noise, and the noise of different components is
// uncorrelated.
#pragma once

#include <Eigen/Dense>

namespace loam::surrogate {

/// outputs = offset + from_scores * scores, with all m directions kept.
struct CurveBasis {
    Eigen::VectorXd offset;       ///< [m] mean of the curves
    Eigen::MatrixXd from_scores;  ///< [m x m]
    Eigen::MatrixXd to_scores;    ///< [m x m] its inverse
    /// [m] variances of the curves' scores, falling; if noise was the metric, its own are about 1 each.
    Eigen::VectorXd score_variance;

    /// Scores [n x m] of curves [n x m].
    Eigen::MatrixXd scores(const Eigen::MatrixXd& curves) const;
};

/// Principal components of curves [n x m] (n >= 2) divided by their own standard deviations.
CurveBasis standardised_basis(const Eigen::MatrixXd& curves);

/// Principal components of curves [n x m] whitened by a noise covariance [m x m], positive definite.
CurveBasis whitened_basis(const Eigen::MatrixXd& curves, const Eigen::MatrixXd& noise);

}  // namespace loam::surrogate
