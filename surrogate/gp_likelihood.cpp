#include "surrogate/gp_likelihood.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "surrogate/linear_algebra.hpp"

namespace loam::surrogate {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd Hyperparameters::to_log() const {
    VectorXd log(2 + length_scales.size());
    log << std::log(variance), length_scales.array().log().matrix(), std::log(nugget);
    return log;
}

Hyperparameters Hyperparameters::from_log(const VectorXd& log) {
    const Index d = log.size() - 2;
    return {.variance = std::exp(log(0)),
            .length_scales = log.segment(1, d).array().exp(),
            .nugget = std::exp(log(1 + d))};
}

void GaussianProcessSystem::q_matrix(MatrixXd& q) const {
    gram(inverse_factor, q);
    for (Index j = 0; j < ones.size(); ++j) {
        const Index rest = ones.size() - j;
        q.col(j).tail(rest) -= (ones(j) / mean_precision) * ones.tail(rest);
    }
}

VectorXd GaussianProcessSystem::q_diagonal() const {
    return inverse_factor.colwise().squaredNorm().transpose() - ones.cwiseAbs2() / mean_precision;
}

// The head of gp_likelihood.hpp with K diagonal; its maximum over the nugget is in closed form.
double constant_log_likelihood(const GroupedData& data) {
    const ArrayXd count = data.count.array(), factor = data.noise_factor.array(), weight = count / factor;
    const double rows = count.sum(), mean = (weight * data.mean.array()).sum() / weight.sum();
    const double squares =
        (weight * (data.mean.array() - mean).square() + data.scatter.array() / factor).sum();
    const double nugget = squares / (rows - 1);
    const double determinants = (count * (nugget * factor).log()).sum();  // of means and of what is within
    return -0.5 * ((rows - 1) * std::log(2 * std::numbers::pi) + determinants +
                   std::log(weight.sum() / (nugget * rows)) + rows - 1);
}

bool RestrictedLikelihood::solve(const Hyperparameters& at, GaussianProcessSystem& system) {
    return solve(ArdCovariance(kernel_, data_.inputs, at.variance, at.length_scales), at.nugget, system);
}

bool RestrictedLikelihood::solve(const ArdCovariance& covariance, double nugget,
                                 GaussianProcessSystem& system) {
    covariance.matrix(value_, slope_);
    const ArrayXd count = data_.count.array();
    system.noise = (nugget * data_.noise_factor + data_.known_variance).array() + floor_;
    system.inverse_factor = value_;
    system.inverse_factor.diagonal() += (system.noise.array() / count).matrix();
    double log_determinant = 0;
    if (!invert_factor(system.inverse_factor, log_determinant)) return false;

    const VectorXd y = lower_product(system.inverse_factor, data_.mean);
    const VectorXd one = lower_product(system.inverse_factor, VectorXd::Ones(y.size()));
    system.mean_precision = one.squaredNorm();
    system.mean = one.dot(y) / system.mean_precision;
    const VectorXd residual = y - system.mean * one;
    system.alpha = transposed_lower_product(system.inverse_factor, residual);
    system.ones = transposed_lower_product(system.inverse_factor, one);

    const double rows = count.sum();
    const double within = ((count - 1) * system.noise.array().log() + count.log() +
                           data_.scatter.array() / system.noise.array())
                              .sum();
    system.log_likelihood = -0.5 * ((rows - 1) * std::log(2 * std::numbers::pi) + log_determinant +
                                    std::log(system.mean_precision / rows) + residual.squaredNorm() + within);
    return std::isfinite(system.log_likelihood);
}

double RestrictedLikelihood::value(const VectorXd& log_parameters, VectorXd* gradient) {
    const Hyperparameters at = Hyperparameters::from_log(log_parameters);
    const ArdCovariance covariance(kernel_, data_.inputs, at.variance, at.length_scales);
    if (!solve(covariance, at.nugget, system_)) return std::numeric_limits<double>::quiet_NaN();
    if (!gradient) return system_.log_likelihood;

    // alpha alpha' - Q, lower triangle.
    system_.q_matrix(weights_);
    const Index g = data_.mean.size();
    for (Index j = 0; j < g; ++j)
        weights_.col(j).tail(g - j) =
            system_.alpha(j) * system_.alpha.tail(g - j) - weights_.col(j).tail(g - j);
    const ArrayXd count = data_.count.array(), noise = system_.noise.array();
    const VectorXd by_noise = 0.5 * (weights_.diagonal().array() / count - (count - 1) / noise +
                                     data_.scatter.array() / noise.square());
    gradient->resize(log_parameters.size());
    gradient->head(log_parameters.size() - 1) = 0.5 * covariance.contract(value_, slope_, weights_);
    (*gradient)(log_parameters.size() - 1) = at.nugget * by_noise.dot(data_.noise_factor);
    return system_.log_likelihood;
}

}  // namespace loam::surrogate
