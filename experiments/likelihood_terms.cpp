#include "experiments/likelihood_terms.hpp"

#include <algorithm>
#include <cmath>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of the misfit along a curve, over its length (by the root of strain): a model that is too strong at the
// start says little of the end.
constexpr double correlation_length = 0.25;

MatrixXd correlation(const ObservedCurve& curve) {
    const Index n = curve.along.size();
    MatrixXd out(n, n);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i)
            out(i, j) = std::exp(-std::abs(curve.along[i] - curve.along[j]) / correlation_length);
    return out;
}

bool is_stated(const Observation& observation, Index k) {
    return observation.sd && std::isfinite((*observation.sd)[k]);
}

}  // namespace

ReadingNoise::ReadingNoise(const Observation& observation, const std::vector<OutputTransform>& transforms)
    : curves_(curves_of(observation)), misfit_priors_(misfit_priors_of(observation)) {
    const Index m = observation.measured.size();
    slope_.resize(m);
    measurement_.resize(m);
    bool several = false;
    for (const ObservedCurve& curve : curves_) {
        several = several || curve.test != curves_.front().test;
        correlations_.push_back(correlation(curve));
        for (Index k = curve.first; k < curve.first + curve.count; ++k) {
            const double y = observation.measured[k];
            slope_[k] = transforms[static_cast<std::size_t>(k)].derivative(std::max(y, 0.0));
            const double sd = is_stated(observation, k)
                                  ? (*observation.sd)[k]
                                  : std::hypot(curve.unit * curve.floor, curve.relative * y);
            measurement_[k] = sd * sd;
        }
    }
    if (!several) return;
    same_specimen_ = MatrixXd::Zero(m, m);
    for (const ObservedCurve& a : curves_)
        for (const ObservedCurve& b : curves_)
            if (a.test == b.test) same_specimen_.block(a.first, b.first, a.count, b.count).setOnes();
}

void ReadingNoise::add(const VectorXd& misfits, MatrixXd& c) const {
    for (std::size_t at = 0; at < curves_.size(); ++at) {
        const ObservedCurve& curve = curves_[at];
        const double sd = curve.unit * misfits[curve.misfit];
        const bool independent = correlations_[at].size() == 0;
        for (Index k = curve.first; k < curve.first + curve.count; ++k)
            c(k, k) += (measurement_[k] + (independent ? sd * sd : 0)) * slope_[k] * slope_[k];
        if (independent) continue;
        const VectorXd scaled = sd * slope_.segment(curve.first, curve.count);
        c.block(curve.first, curve.first, curve.count, curve.count) +=
            scaled.asDiagonal() * correlations_[at] * scaled.asDiagonal();
    }
}

MatrixXd ReadingNoise::of_specimens(const MatrixXd& packing_noise) const {
    if (same_specimen_.size() == 0) return packing_noise;
    return packing_noise.cwiseProduct(same_specimen_);
}

const surrogate::Prior misfit_prior{surrogate::PriorKind::lognormal, -3.5, 0.5, 2e-5, 0.05};

VectorXd reading_variance(const Observation& observation, const OutputTransform& transform, double misfit) {
    VectorXd out(observation.measured.size());
    for (Index k = 0; k < out.size(); ++k) {
        const double y = observation.measured[k], slope = transform.derivative(std::max(y, 0.0));
        const double sd = is_stated(observation, k) ? (*observation.sd)[k]
                                                    : std::hypot(observation.floor, observation.relative * y);
        out[k] = (sd * sd + misfit * misfit) * slope * slope;
    }
    return out;
}

void prior_residuals(const ParameterSpace& space, const VectorXd& x, Index first, VectorXd& out,
                     MatrixXd* jacobian) {
    for (Index k = 0; k < space.dimension(); ++k) {
        // A truncated normal's log density has the derivative (mean - x) / sd²; a uniform's is zero.
        const double at0 = space.prior(k).log_density_derivative_unit(0);
        const double curvature = at0 - space.prior(k).log_density_derivative_unit(1);
        const double root = std::sqrt(std::max(curvature, 0.0));
        out[first + k] = curvature > 0 ? root * (x[k] - at0 / curvature) : 0.0;
        if (jacobian) (*jacobian)(first + k, k) = root;
    }
}

}  // namespace loam::experiments
