#include "experiments/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "experiments/residual_factor.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using surrogate::CurveNoise;

// The emulator's variance over the typical one between its runs, at most. The design covers the prior, so
// more is left open only where runs failed, and there it must not stand in for the model's misfit, whose size
// has a prior (after Liu, Bayarri & Berger 2009, who keep what one part of a model lacks from being made up
// by another).
constexpr double beyond_typical = 9;

}  // namespace

Likelihood::Likelihood(const TrainedEmulator& trained, const ParameterSpace& space,
                       const Observation& observation, int packings, StrainMisfit strain)
    : trained_(trained),
      space_(space),
      observation_(observation),
      readings_(observation, trained.transforms, strain),
      packings_(packings),
      most_open_(beyond_typical * trained.emulator.typical_variance()) {
    const Index m = observation.measured.size();
    loadings_ = trained.emulator.loadings();
    target_.resize(m);
    large_specimen_ =
        0.5 * (1 - std::min(1.0, observation.packing_share)) * trained.emulator.noise().centre.diagonal();
    for (Index k = 0; k < m; ++k) {
        const OutputTransform& transform = trained.transforms[static_cast<std::size_t>(k)];
        target_[k] = transform.forward(observation.measured[k]);
        if (transform.linear) large_specimen_[k] = 0;
    }
}

VectorXd Likelihood::misfits_at(const VectorXd& theta) const {
    VectorXd out(misfits());
    for (Index k = 0; k < out.size(); ++k) out[k] = misfit_prior_of(k).from_unit(theta[parameters() + k]);
    return out;
}

MatrixXd Likelihood::covariance(const VectorXd& theta, const VectorXd& open) const {
    const CurveNoise& noise = trained_.emulator.noise();
    MatrixXd c =
        loadings_ * open.asDiagonal() * loadings_.transpose() +
        observation_.packing_share * readings_.of_specimens(noise.covariance(theta.head(parameters())));
    readings_.add(misfits_at(theta), c);
    return c;
}

VectorXd Likelihood::open_at(const VectorXd& theta) const {
    return trained_.emulator.predict_components(theta.head(parameters())).variance.cwiseMin(most_open_);
}

double Likelihood::log_prior(const VectorXd& theta) const {
    double sum = 0;
    for (Index k = 0; k < parameters(); ++k) sum += space_.prior(k).log_density_unit(theta[k]);
    for (Index k = 0; k < misfits(); ++k) sum += misfit_prior_of(k).log_density_unit(theta[parameters() + k]);
    return sum;
}

double Likelihood::log_posterior(const VectorXd& theta) const {
    const auto at = trained_.emulator.predict_components(theta.head(parameters()));
    return log_posterior(theta, at.mean, at.variance.cwiseMin(most_open_));
}

double Likelihood::log_representative(const VectorXd& theta, const VectorXd& open) const {
    return log_posterior(theta, trained_.emulator.predict_component_means(theta.head(parameters())), open);
}

double Likelihood::log_expected(const VectorXd& theta) const {
    const auto at = trained_.emulator.predict_components(theta.head(parameters()));
    return log_density(theta, trained_.emulator.offset() + loadings_ * at.mean,
                       at.variance.cwiseMin(most_open_), observation_.packing_share, true);
}

double Likelihood::log_by_runs(const VectorXd& theta, const VectorXd& mean, double runs) const {
    const VectorXd none = VectorXd::Zero(loadings_.cols());
    return log_density(theta, mean, none, observation_.packing_share + 1 / runs);
}

void Likelihood::residuals(const VectorXd& x, const Eigen::LLT<MatrixXd>& factor, VectorXd& out,
                           MatrixXd* jacobian) const {
    const Index m = target_.size(), d = parameters();
    MatrixXd slope;
    const VectorXd mean = trained_.emulator.predict_mean(x, jacobian ? &slope : nullptr) +
                          large_specimen(trained_.emulator.noise().scale(x));
    out.resize(m + d);
    out.head(m) = factor.matrixL().solve(target_ - mean);
    if (jacobian) {
        jacobian->setZero(m + d, d);
        jacobian->topRows(m) = -factor.matrixL().solve(slope);
    }
    prior_residuals(space_, x, m, out, jacobian);
}

double Likelihood::log_posterior(const VectorXd& theta, const VectorXd& components,
                                 const VectorXd& open) const {
    return log_density(theta, trained_.emulator.offset() + loadings_ * components, open,
                       observation_.packing_share);
}

double Likelihood::log_density(const VectorXd& theta, const VectorXd& mean, const VectorXd& open,
                               double packings, bool expected) const {
    const CurveNoise& noise = trained_.emulator.noise();
    const double scale = noise.scale(theta.head(parameters()));
    const VectorXd residuals = target_ - mean - large_specimen(scale);
    const VectorXd misfits = misfits_at(theta);
    ResidualFactor factor(loadings_, open, residuals);
    for (const Stretch& at : readings_.specimens()) {
        MatrixXd block = packings * scale * noise.centre.block(at.first, at.first, at.count, at.count);
        readings_.add(misfits, block, at.first);
        if (!factor.add(at, block)) return -INFINITY;
    }
    const std::optional<double> density = expected ? factor.expected_log_density() : factor.log_density();
    if (!density) return -INFINITY;
    return *density + log_prior(theta) +
           packings_ * trained_.feasibility.log_success(theta.head(parameters()));
}

}  // namespace loam::experiments
