#include "experiments/likelihood_terms.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace loam::experiments {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of the misfit along a curve, over its length (by the root of strain): a model that is too strong at the
// start says little of the end.
constexpr double correlation_length = 0.25;

// Of a reading that hardly any strain leads to, over that of a reading of loading.
constexpr double most_variance = 100;
constexpr double least_strain = 1e-12;  // a reading, so that nothing is divided by nothing

/// Strain gone through per reading in readings `from` .. `to`, beginning at the strain `at`.
double strain_per_reading(const VectorXd& strain, Index from, Index to, double at) {
    double gone = 0;
    for (Index k = from; k < to; ++k) gone += std::abs(strain[k] - std::exchange(at, strain[k]));
    return gone / static_cast<double>(to - from);
}

/// See StrainMisfit::nearest; `strain` [count] of the curve.
MatrixXd of_rebound(const ObservedCurve& curve, const VectorXd& strain) {
    MatrixXd out = MatrixXd::Identity(curve.count, curve.count);
    const Index loading = curve.phases.size() > 1 ? curve.phases[1] : curve.count;
    const double loaded = strain_per_reading(strain, 0, loading, 0);
    for (std::size_t phase = 1; phase < curve.phases.size(); ++phase) {
        const Index end = curve.phases[phase] - 1;  // of the phase before
        const Index next = phase + 1 < curve.phases.size() ? curve.phases[phase + 1] : curve.count;
        const double gone = strain_per_reading(strain, end + 1, next, strain[end]);
        const double variance = std::clamp(loaded / std::max(gone, least_strain), 1.0, most_variance);
        for (Index k = end + 1; k < next; ++k) {
            out.row(k).head(k) = out.row(end).head(k);
            out.row(k).segment(end, k - end).setConstant(out(end, end));
            out(k, k) = out(end, end) + variance;
            out.col(k).head(k) = out.row(k).head(k).transpose();
        }
    }
    return out;
}

MatrixXd correlation(const ObservedCurve& curve, const VectorXd& measured, StrainMisfit strain) {
    const bool is_strain = !curve.phases.empty();
    const VectorXd own = measured.segment(curve.first, curve.count);
    if (is_strain && strain == StrainMisfit::nearest) return of_rebound(curve, own);
    const VectorXd along = is_strain ? places_along(own) : curve.along;
    const Index n = along.size();
    MatrixXd out(n, n);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i)
            out(i, j) = std::exp(-std::abs(along[i] - along[j]) / correlation_length);
    return out;
}

bool is_stated(const Observation& observation, Index k) {
    return observation.sd && std::isfinite((*observation.sd)[k]);
}

}  // namespace

ReadingNoise::ReadingNoise(const Observation& observation, const std::vector<OutputTransform>& transforms,
                           StrainMisfit strain)
    : curves_(curves_of(observation)), misfit_priors_(misfit_priors_of(observation)) {
    const Index m = observation.measured.size();
    slope_.resize(m);
    measurement_.resize(m);
    int test = -1;
    for (const ObservedCurve& curve : curves_) {
        if (specimens_.empty() || curve.test != test) specimens_.push_back({curve.first, 0});
        test = curve.test;
        specimens_.back().count += curve.count;
        correlations_.push_back(correlation(curve, observation.measured, strain));
        for (Index k = curve.first; k < curve.first + curve.count; ++k) {
            const double y = observation.measured[k];
            slope_[k] = transforms[static_cast<std::size_t>(k)].derivative(std::max(y, 0.0));
            const double sd = is_stated(observation, k)
                                  ? (*observation.sd)[k]
                                  : std::hypot(curve.unit * curve.floor, curve.relative * y);
            measurement_[k] = sd * sd;
        }
    }
}

void ReadingNoise::add(const VectorXd& misfits, MatrixXd& c, Index first) const {
    for (std::size_t at = 0; at < curves_.size(); ++at) {
        const ObservedCurve& curve = curves_[at];
        if (curve.first < first || curve.first >= first + c.rows()) continue;
        const Index from = curve.first - first;
        const double sd = curve.misfit_sd(misfits);
        const bool independent = correlations_[at].size() == 0;
        for (Index k = curve.first; k < curve.first + curve.count; ++k)
            c(k - first, k - first) +=
                (measurement_[k] + (independent ? sd * sd : 0)) * slope_[k] * slope_[k];
        if (independent) continue;
        const VectorXd scaled = sd * slope_.segment(curve.first, curve.count);
        c.block(from, from, curve.count, curve.count) +=
            scaled.asDiagonal() * correlations_[at] * scaled.asDiagonal();
    }
}

MatrixXd ReadingNoise::of_specimens(const MatrixXd& packing_noise) const {
    if (specimens_.size() == 1) return packing_noise;
    MatrixXd out = MatrixXd::Zero(packing_noise.rows(), packing_noise.cols());
    for (const auto [first, count] : specimens_)
        out.block(first, first, count, count) = packing_noise.block(first, first, count, count);
    return out;
}

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
