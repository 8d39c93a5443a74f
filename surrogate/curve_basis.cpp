#include "surrogate/curve_basis.hpp"

#include <stdexcept>

namespace loam::surrogate {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// With metric = factor * factor', curves are whitened by factor^-1.
CurveBasis rotated(const MatrixXd& curves, const MatrixXd& factor, const MatrixXd& inverse) {
    CurveBasis basis;
    basis.offset = curves.colwise().mean();
    const MatrixXd whitened = (curves.rowwise() - basis.offset.transpose()) * inverse.transpose();
    const MatrixXd covariance = whitened.transpose() * whitened / static_cast<double>(curves.rows() - 1);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(covariance);
    if (eigen.info() != Eigen::Success)
        throw std::runtime_error("curve emulator: the principal components did not converge");
    const MatrixXd rotation = eigen.eigenvectors().rowwise().reverse();  // largest variance first
    basis.score_variance = eigen.eigenvalues().reverse().cwiseMax(0.0);
    basis.from_scores = factor * rotation;
    basis.to_scores = rotation.transpose() * inverse;
    return basis;
}

}  // namespace

MatrixXd CurveBasis::scores(const MatrixXd& curves) const {
    return (curves.rowwise() - offset.transpose()) * to_scores.transpose();
}

CurveBasis standardised_basis(const MatrixXd& curves) {
    VectorXd sd = (curves.rowwise() - curves.colwise().mean()).colwise().norm().transpose() /
                  std::sqrt(static_cast<double>(curves.rows() - 1));
    // An output that never changes must not divide by zero; beside the others it counts as still.
    const double largest = sd.maxCoeff();
    sd = largest > 0 ? sd.cwiseMax(1e-6 * largest).eval() : VectorXd::Ones(sd.size()).eval();
    return rotated(curves, sd.asDiagonal(), sd.cwiseInverse().asDiagonal());
}

CurveBasis whitened_basis(const MatrixXd& curves, const MatrixXd& noise) {
    const Eigen::LLT<MatrixXd> cholesky(noise);
    if (cholesky.info() != Eigen::Success)
        throw std::runtime_error("curve emulator: the noise covariance is not positive definite");
    const MatrixXd factor = cholesky.matrixL();
    const MatrixXd inverse = cholesky.matrixL().solve(MatrixXd::Identity(noise.rows(), noise.rows()));
    return rotated(curves, factor, inverse);
}

}  // namespace loam::surrogate
