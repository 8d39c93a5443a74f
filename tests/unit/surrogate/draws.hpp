// Draws from known normal distributions, and the covariances behind them, written apart from the code under
// test.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "optimizers/random.hpp"

namespace loam::surrogate {

inline Eigen::VectorXd standard_normals(Eigen::Index n, optimizers::Random& random) {
    Eigen::VectorXd z(n);
    for (double& value : z) value = random.normal();
    return z;
}

/// A draw from the normal with mean 0 and this covariance.
inline Eigen::VectorXd draw(const Eigen::MatrixXd& covariance, optimizers::Random& random) {
    const Eigen::LLT<Eigen::MatrixXd> cholesky(covariance);
    return cholesky.matrixL() * standard_normals(covariance.rows(), random);
}

/// Matern-5/2 covariance between the rows of a and b, entry by entry (Rasmussen & Williams 2006, eq. 4.17).
inline Eigen::MatrixXd matern_between(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double variance,
                                      const Eigen::VectorXd& lengths) {
    Eigen::MatrixXd k(a.rows(), b.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
        for (Eigen::Index j = 0; j < b.rows(); ++j) {
            const double r = (a.row(i) - b.row(j)).transpose().cwiseQuotient(lengths).norm(),
                         s = std::sqrt(5.0) * r;
            k(i, j) = variance * (1 + s + s * s / 3) * std::exp(-s);
        }
    }
    return k;
}

}  // namespace loam::surrogate
