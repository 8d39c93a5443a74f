// The dense operations that cost the time of a Gaussian process, by Eigen compiled for the processor at hand
// (chosen at run time). Safe to call from several threads; the bits depend on the instruction set alone.
// OpenBLAS is about as fast here, but Debian's serial build of it is not safe to call from several threads at
// once.
#pragma once

#include <Eigen/Dense>

namespace loam::surrogate {

/// Replaces the symmetric positive definite matrix A = L L' [n x n], given by its lower triangle, by the
/// inverse of its Cholesky factor, L^-1, zeros included, and sets log_determinant to log |A|. Returns false,
/// A being left as it was, if A is not positive definite to rounding. L^-1 rather than A^-1, for what is
/// built on it, such as A^-1 = (L^-1)' L^-1, loses half the digits that A^-1 itself would lose to a bad
/// condition.
bool invert_factor(Eigen::MatrixXd& matrix, double& log_determinant);

/// Lower triangle of X' X [n x n] for a lower triangular X [n x n] with its zeros.
void gram(const Eigen::MatrixXd& lower, Eigen::MatrixXd& product);

/// X v and X' v [n] for a lower triangular X [n x n].
Eigen::VectorXd lower_product(const Eigen::MatrixXd& lower, const Eigen::VectorXd& vector);
Eigen::VectorXd transposed_lower_product(const Eigen::MatrixXd& lower, const Eigen::VectorXd& vector);

/// X V [n x k] for a lower triangular X [n x n] with its zeros and V [n x k], at several times the speed of k
/// products.
Eigen::MatrixXd lower_products(const Eigen::MatrixXd& lower, const Eigen::MatrixXd& vectors);

}  // namespace loam::surrogate
