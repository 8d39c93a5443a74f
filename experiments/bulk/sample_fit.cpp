#include "experiments/bulk/sample_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/likelihood_terms.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "optimizers/least_squares.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kept_draws = 1000;
constexpr int misfit_grid = 40;
constexpr Index tried_draws = 200;            // of the posterior, among which the search's starts are
constexpr Index starts = 3;                   // of the search for the estimate
constexpr double void_ratio_tolerance = 0.1;  // coordinate: how far off a point of the library may be

class SampleLikelihood {
  public:
    /// `packing_share` is that of fit.hpp's Observation.
    SampleLikelihood(const BulkSample& sample, const GroupEmulator& group, const ParameterSpace& space,
                     double packing_share)
        : sample_(sample), group_(group), space_(space), packing_share_(packing_share) {
        const MatrixXd& w = sample.interpolation;
        const surrogate::CurveEmulator& emulator = group.emulator;
        loadings_ = w * emulator.loadings();
        noise_ = w * emulator.noise().centre * w.transpose();
        large_specimen_ = 0.5 * (1 - std::min(1.0, packing_share)) * (w * emulator.noise().centre.diagonal());
        VectorXd target(w.rows());
        for (Index k = 0; k < w.rows(); ++k)
            target[k] = sample.transform.forward(sample.observation.measured[k]);
        residual_ = target - w * emulator.offset();
    }

    /// From now on errors are additive in strain, not in its transform. Both covariances are the same, taken
    /// at the measured strain; in the transform, that lets a curve pass farther above its readings than
    /// below.
    void compare_strains() { strains_ = true; }

    /// From now on as if the emulator left the same variance open [q] at every set: a search is then not
    /// drawn to where the emulator knows nothing and so excludes nothing.
    void hold_open(VectorXd open) { open_ = std::move(open); }

    Index parameters() const { return space_.dimension(); }
    double misfit(const VectorXd& theta) const {
        return strain_misfit_prior().from_unit(theta[parameters()]);
    }

    /// The emulator's inputs at x [d].
    VectorXd inputs(const VectorXd& x) const {
        VectorXd out(group_.library.rows() - 1 + (has_void_ratio() ? 1 : 0));
        out.head(parameters()) = x.head(parameters());
        if (has_void_ratio()) out[parameters()] = sample_.void_ratio;
        return out;
    }

    double log_likelihood(const VectorXd& theta, const VectorXd& mean, const VectorXd& variance) const {
        const double scale = group_.emulator.noise().scale(inputs(theta));
        const Eigen::LLT<MatrixXd> factor(covariance(theta, variance, scale));
        if (factor.info() != Eigen::Success) return -INFINITY;
        const VectorXd white =
            factor.matrixL().solve(misses(residual_ - loadings_ * mean - scale * large_specimen_));
        double log_root = 0;
        for (Index k = 0; k < white.size(); ++k) log_root += std::log(factor.matrixLLT()(k, k));
        return -0.5 * white.squaredNorm() - log_root;
    }

    double log_prior(const VectorXd& theta) const {
        double sum = strain_misfit_prior().log_density_unit(theta[parameters()]);
        for (Index k = 0; k < parameters(); ++k) sum += space_.prior(k).log_density_unit(theta[k]);
        return sum;
    }

    /// Variance of the components [q] that the emulator leaves open on average at the columns of points.
    VectorXd mean_open(const MatrixXd& points) const {
        MatrixXd mean, variance;
        group_.emulator.predict_components(inputs_of(points), mean, variance);
        return variance.colwise().mean().transpose();
    }

    /// At the columns of points [d + 1 x k].
    VectorXd log_posterior(const MatrixXd& points) const {
        if (open_) {
            VectorXd out(points.cols());
            for (Index k = 0; k < points.cols(); ++k) out[k] = log_posterior_at(points.col(k));
            return out;
        }
        MatrixXd mean, variance;
        group_.emulator.predict_components(inputs_of(points), mean, variance);
        VectorXd out(points.cols());
        for (Index k = 0; k < points.cols(); ++k)
            out[k] = log_likelihood(points.col(k), mean.row(k).transpose(), variance.row(k).transpose()) +
                     log_prior(points.col(k));
        return out;
    }

    /// Log importance weights of the library's points, which are draws of the prior.
    VectorXd library_weights() const {
        VectorXd out(group_.library.cols());
        for (Index k = 0; k < out.size(); ++k) {
            const double off =
                has_void_ratio() ? (group_.library_void_ratio[k] - sample_.void_ratio) / void_ratio_tolerance
                                 : 0.0;
            out[k] = log_likelihood(group_.library.col(k), group_.library_mean.row(k).transpose(),
                                    group_.library_variance.row(k).transpose()) -
                     0.5 * off * off;
        }
        return out;
    }

    /// With the variance held open.
    double log_posterior_at(const VectorXd& theta) const {
        return log_likelihood(theta, group_.emulator.predict_component_means(inputs(theta)), *open_) +
               log_prior(theta);
    }

    /// With the variance held open.
    MatrixXd covariance(const VectorXd& theta) const {
        return covariance(theta, *open_, group_.emulator.noise().scale(inputs(theta)));
    }

    /// The misfit's coordinate that is most probable with the others as they are.
    void improve_misfit(VectorXd& theta, double& value) const {
        const VectorXd mean = group_.emulator.predict_component_means(inputs(theta));
        VectorXd candidate = theta;
        for (int k = 0; k <= misfit_grid; ++k) {
            candidate[parameters()] = static_cast<double>(k) / misfit_grid;
            const double now = log_likelihood(candidate, mean, *open_) + log_prior(candidate);
            if (now <= value) continue;
            value = now;
            theta[parameters()] = candidate[parameters()];
        }
    }

    double emulator_share(const VectorXd& theta) const {
        const surrogate::ComponentPrediction at = group_.emulator.predict_components(inputs(theta));
        const double scale = group_.emulator.noise().scale(inputs(theta));
        return (loadings_.cwiseAbs2() * at.variance).sum() / covariance(theta, at.variance, scale).trace();
    }

    /// Residuals whitened by a covariance, with the priors of the parameters as further residuals.
    void residuals(const VectorXd& x, const Eigen::LLT<MatrixXd>& factor, VectorXd& out,
                   MatrixXd* jacobian) const {
        const Index m = residual_.size(), d = parameters();
        const VectorXd at = inputs(x);
        MatrixXd slope;
        const VectorXd mean =
            sample_.interpolation * group_.emulator.predict_mean(at, jacobian ? &slope : nullptr);
        out.resize(m + d);
        const VectorXd difference = residual_ + sample_.interpolation * group_.emulator.offset() - mean -
                                    group_.emulator.noise().scale(at) * large_specimen_;
        out.head(m) = factor.matrixL().solve(misses(difference));
        if (jacobian) {
            MatrixXd change = sample_.interpolation * slope.leftCols(d);
            if (strains_) change = (-difference).array().exp().matrix().asDiagonal() * change;
            jacobian->setZero(m + d, d);
            jacobian->topRows(m) = -factor.matrixL().solve(change);
        }
        prior_residuals(space_, x, m, out, jacobian);
    }

    /// The curve at x, as the mean of direct runs would show it, SI.
    VectorXd curve(const VectorXd& x) const {
        const VectorXd at = inputs(x), t = group_.emulator.predict_mean(at);
        const VectorXd spread = group_.emulator.noise().covariance(at).diagonal();
        const VectorXd mean = sample_.interpolation * (t + 0.5 * spread);
        VectorXd out(mean.size());
        for (Index k = 0; k < out.size(); ++k) out[k] = sample_.transform.inverse(mean[k]);
        return out;
    }

  private:
    /// Of measured minus simulated on the transformed scale: the same, or that of the strains over the
    /// transform's slope at the measured one.
    VectorXd misses(const VectorXd& difference) const {
        if (!strains_) return difference;
        VectorXd out = difference;
        for (double& d : out) d = -std::expm1(-d);
        return out;
    }

    bool has_void_ratio() const {
        return group_.emulator.processes().front().data().inputs.cols() > parameters();
    }

    /// One row a column of points.
    MatrixXd inputs_of(const MatrixXd& points) const {
        MatrixXd out(points.cols(), inputs(points.col(0)).size());
        for (Index k = 0; k < points.cols(); ++k) out.row(k) = inputs(points.col(k)).transpose();
        return out;
    }

    MatrixXd covariance(const VectorXd& theta, const VectorXd& variance, double scale) const {
        MatrixXd c = loadings_ * variance.asDiagonal() * loadings_.transpose();
        c += packing_share_ * scale * noise_;
        c.diagonal() += reading_variance(sample_.observation, sample_.transform, misfit(theta));
        return c;
    }

    const BulkSample& sample_;
    const GroupEmulator& group_;
    const ParameterSpace& space_;
    double packing_share_;
    MatrixXd loadings_, noise_;           // at the sample's readings
    VectorXd large_specimen_, residual_;  // residual_: measured minus the emulator's offset
    std::optional<VectorXd> open_;        // [q]
    bool strains_ = false;
};

/// Least squares from theta with the covariance held at it, and the misfit, in turns as long as that gains.
void refine(const SampleLikelihood& likelihood, VectorXd& theta, double& value) {
    const Index d = likelihood.parameters();
    for (int pass = 0; pass < 4; ++pass) {
        const double before = value;
        likelihood.improve_misfit(theta, value);
        const Eigen::LLT<MatrixXd> factor(likelihood.covariance(theta));
        if (factor.info() != Eigen::Success) return;
        const auto residuals = [&](const VectorXd& x, VectorXd& r, MatrixXd* jacobian) {
            likelihood.residuals(x, factor, r, jacobian);
        };
        optimizers::Options options;
        options.max_evaluations = 60;
        options.relative_tolerance = 1e-6;
        const auto found =
            optimizers::minimise_least_squares(residuals, optimizers::unit_cube(d), theta.head(d), options);
        VectorXd candidate = theta;
        candidate.head(d) = found.minimum.x;
        const double better = likelihood.log_posterior_at(candidate);
        if (better > value) {
            theta = candidate;
            value = better;
        }
        if (value - before < 1e-2) return;
    }
}

/// The most probable set [d + 1] under `likelihood`, from the best of the points [d + 1 x k].
VectorXd search(const SampleLikelihood& likelihood, const MatrixXd& points) {
    VectorXd values = likelihood.log_posterior(points);
    VectorXd best;
    double best_value = -INFINITY;
    for (Index k = 0; k < starts; ++k) {
        Index at = 0;
        double value = values.maxCoeff(&at);
        if (!std::isfinite(value)) break;
        VectorXd theta = points.col(at);
        // Starts that are neighbours end alike.
        for (Index j = 0; j < values.size(); ++j)
            if ((points.col(j) - theta).cwiseAbs().maxCoeff() < 0.1) values[j] = -INFINITY;
        refine(likelihood, theta, value);
        if (value <= best_value) continue;
        best = theta;
        best_value = value;
    }
    if (best.size() == 0) throw std::runtime_error("the likelihood is nowhere finite");
    return best;
}

/// Of the group's library; throws std::runtime_error where nothing in it has a density.
VectorXd library_weights(const SampleLikelihood& likelihood) {
    VectorXd weights = likelihood.library_weights();
    if (!weights.array().isFinite().any())
        throw std::runtime_error("no parameters of the prior give a curve that could be this one");
    return weights;
}

/// The posterior. Where it lies is learnt first with a variance of the emulator that is the same everywhere:
/// the variance at a point costs twenty times its mean.
optimizers::WeightedDraws sample_posterior_of(const SampleLikelihood& likelihood, const GroupEmulator& group,
                                              optimizers::ImportanceOptions options) {
    const VectorXd weights = library_weights(likelihood);
    SampleLikelihood rough = likelihood;
    const VectorXd share = (weights.array() - weights.maxCoeff()).exp().matrix();
    rough.hold_open(group.library_variance.transpose() * share / share.sum());
    options.rounds = options.most_rounds = 2;
    const optimizers::WeightedDraws place = optimizers::sample_by_importance(
        [&](const MatrixXd& points) { return rough.log_posterior(points); }, group.library, weights, options);
    options.rounds = 1;
    options.most_rounds = 8;
    options.seed = run_seed(options.seed, 1, 0);
    return optimizers::sample_by_importance(
        [&](const MatrixXd& points) { return likelihood.log_posterior(points); }, place.draws.transpose(),
        place.weight.array().log().matrix(), options);
}

}  // namespace

SampleFit fit_sample(const BulkSample& sample, const GroupEmulator& group, const ParameterSpace& space,
                     const Settings& settings, std::uint64_t seed) {
    const SampleLikelihood likelihood(sample, group, space, sample.observation.packing_share);
    optimizers::ImportanceOptions options;
    options.draws = std::max(50, settings.bulk.posterior_draws / 2);
    options.last_draws = std::max(50, settings.bulk.posterior_draws);
    options.seed = seed;
    const optimizers::WeightedDraws posterior = sample_posterior_of(likelihood, group, options);
    SampleLikelihood representative(sample, group, space, 0);
    representative.compare_strains();
    const MatrixXd tried = posterior.resampled(tried_draws).transpose();
    representative.hold_open(representative.mean_open(tried).cwiseMin(group.typical_variance));
    const VectorXd theta = search(representative, tried);

    SampleFit out;
    out.estimate = theta.head(space.dimension());
    out.misfit = representative.misfit(theta);
    out.quantiles = quantiles_of(posterior.resampled(kept_draws).leftCols(space.dimension()));
    out.effective = posterior.effective;
    out.emulator_share = representative.emulator_share(theta);
    out.predicted = representative.curve(out.estimate);
    return out;
}

VectorXd predicted_curve(const BulkSample& sample, const GroupEmulator& group, const ParameterSpace& space,
                         const VectorXd& x) {
    return SampleLikelihood(sample, group, space, 0).curve(x);
}

MatrixXd likely_points(const BulkSample& sample, const GroupEmulator& group, const ParameterSpace& space,
                       Index count, std::uint64_t seed) {
    const SampleLikelihood likelihood(sample, group, space, sample.observation.packing_share);
    optimizers::ImportanceOptions options;
    options.rounds = options.most_rounds = 1;
    options.last_draws = 100;
    options.seed = seed;
    return optimizers::sample_by_importance(
               [&](const MatrixXd& points) { return likelihood.log_posterior(points); }, group.library,
               library_weights(likelihood), options)
        .resampled(count)
        .leftCols(space.dimension());
}

}  // namespace loam::experiments
