#include "experiments/diagnosis/linear_model.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace loam::experiments {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Projection::Projection(const LinearModel& model) : model_(model) {
    const Eigen::Index m = model.residual.size();
    if (model.jacobian.rows() != m || model.noise.rows() != m || model.noise.cols() != m ||
        model.jacobian.cols() != model.prior_sd.size())
        throw std::invalid_argument(
            "Projection: the sizes of residual, jacobian, noise and priors do not fit");
    const MatrixXd spread = model.jacobian * model.prior_sd.asDiagonal();
    marginal_.compute(model.noise + spread * spread.transpose());
    if (marginal_.info() != Eigen::Success)
        throw std::invalid_argument("Projection: the noise is not positive definite");
}

VectorXd Projection::projected(const VectorXd& curve) const {
    return model_.noise * marginal_.solve(curve);
}

double Projection::inner(const VectorXd& a, const VectorXd& b) const {
    return a.dot(marginal_.solve(b));
}

double Projection::norm(const VectorXd& a) const {
    return std::sqrt(std::max(0.0, inner(a, a)));
}

VectorXd Projection::weights(const VectorXd& curve) const {
    return marginal_.solve(curve);
}

double Projection::log_evidence() const {
    const double log_det = 2 * marginal_.matrixL().toDenseMatrix().diagonal().array().log().sum();
    return -0.5 * (inner(model_.residual, model_.residual) + log_det +
                   static_cast<double>(size()) * std::log(2 * std::numbers::pi));
}

VectorXd Projection::projected_weights(const VectorXd& weights) const {
    return marginal_.solve(model_.noise * weights);
}

MatrixXd Projection::covariance_of(const MatrixXd& rows) const {
    const MatrixXd half = rows * marginal_.matrixL().toDenseMatrix();
    return half * half.transpose();
}

VectorXd Projection::draw(const VectorXd& normals) const {
    return marginal_.matrixL() * normals;
}

}  // namespace loam::experiments
