#include "experiments/cross_test.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// What the data of a posterior say: its precision without the prior's, with negative directions, which only
/// the sampling of the posterior makes, set to zero.
MatrixXd information(const Gaussian& g, const VectorXd& prior_precision) {
    const Index d = g.mean.size();
    MatrixXd precision = g.covariance.ldlt().solve(MatrixXd::Identity(d, d));
    precision -= prior_precision.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(0.5 * (precision + precision.transpose()));
    return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0.0).asDiagonal() *
           modes.eigenvectors().transpose();
}

}  // namespace

Gaussian gaussian_of(const Fit& fit, Index d) {
    const MatrixXd x = fit.posterior.draws.leftCols(d);
    Gaussian out{x.colwise().mean().transpose(), {}};
    const MatrixXd centred = x.rowwise() - out.mean.transpose();
    out.covariance = centred.transpose() * centred / static_cast<double>(std::max<Index>(1, x.rows() - 1));
    return out;
}

Agreement compare_sets(const Gaussian& a, const Gaussian& b, const VectorXd& prior_precision,
                       const VectorXd& prior_mean) {
    constexpr double says_nothing = 0.1, flat = 12;  // a uniform prior has the variance 1/12
    const Index d = a.mean.size();
    const MatrixXd of_a = information(a, prior_precision), of_b = information(b, prior_precision);
    const VectorXd prior = (prior_precision.array() > 0).select(prior_precision, flat);
    const auto weighted = [&](const Gaussian& g, const MatrixXd& of_g) {
        return VectorXd(of_g * g.mean + prior_precision.cwiseProduct(g.mean - prior_mean));
    };
    const VectorXd sum_a = weighted(a, of_a), sum_b = weighted(b, of_b);
    MatrixXd total = of_a + of_b;
    total.diagonal() += 1e-9 * prior;
    // Columns u with u' total u = 1, along which both are diagonal.
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(of_a, total);
    Agreement out;
    out.difference = VectorXd::Zero(d);
    VectorXd variance = VectorXd::Zero(d);
    for (Index k = 0; k < d; ++k) {
        const VectorXd u = modes.eigenvectors().col(k);
        const double in_a = u.dot(of_a * u), in_b = u.dot(of_b * u),
                     least = says_nothing * u.cwiseAbs2().dot(prior);
        if (in_a < least || in_b < least) continue;
        const double shift = u.dot(sum_b) / in_b - u.dot(sum_a) / in_a, spread = 1 / in_a + 1 / in_b;
        out.statistic += shift * shift / spread;
        out.difference += shift * u;
        variance += spread * u.cwiseAbs2();
        ++out.degrees;
    }
    out.sd = variance.cwiseSqrt();
    if (out.degrees > 0)
        out.p_value = boost::math::cdf(
            complement(boost::math::chi_squared(static_cast<double>(out.degrees)), out.statistic));
    return out;
}

void prior_as_normal(const ParameterSpace& space, VectorXd& precision, VectorXd& mean) {
    const Index d = space.dimension();
    precision = VectorXd::Zero(d);
    mean = VectorXd::Constant(d, 0.5);
    for (Index k = 0; k < d; ++k) {
        // The derivative of a truncated normal's log density is linear; that of a uniform one is zero.
        const double at0 = space.prior(k).log_density_derivative_unit(0);
        const double slope = at0 - space.prior(k).log_density_derivative_unit(1);
        if (slope <= 0) continue;
        precision[k] = slope;
        mean[k] = at0 / slope;
    }
}

}  // namespace loam::experiments
