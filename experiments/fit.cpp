#include "experiments/fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/likelihood_terms.hpp"
#include "experiments/residual_factor.hpp"
#include "experiments/settings/validation.hpp"
#include "optimizers/least_squares.hpp"
#include "optimizers/registry.hpp"
#include "surrogate/kernels/registry.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using surrogate::CurveNoise;

constexpr double identified_below = 0.75;  // posterior over prior width
// The emulator's variance over the typical one between its runs, at most. The design covers the prior, so
// more is left open only where runs failed, and there it must not stand in for the model's misfit, whose size
// has a prior (after Liu, Bayarri & Berger 2009, who keep what one part of a model lacks from being made up
// by another).
constexpr double beyond_typical = 9;

class Likelihood {
  public:
    /// `packings`: so many runs at a set must come to an end.
    Likelihood(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation,
               int packings, StrainMisfit strain = StrainMisfit::along)
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

    Index parameters() const { return space_.dimension(); }
    Index dimension() const { return parameters() + misfits(); }
    Index misfits() const { return static_cast<Index>(readings_.misfit_priors().size()); }
    const surrogate::Prior& misfit_prior_of(Index which) const {
        return readings_.misfit_priors()[static_cast<std::size_t>(which)];
    }
    VectorXd misfits_at(const VectorXd& theta) const {
        VectorXd out(misfits());
        for (Index k = 0; k < out.size(); ++k) out[k] = misfit_prior_of(k).from_unit(theta[parameters() + k]);
        return out;
    }

    /// Of the residuals [m x m], with `open` [q] the variance of each component that the emulator leaves
    /// open.
    MatrixXd covariance(const VectorXd& theta, const VectorXd& open) const {
        const CurveNoise& noise = trained_.emulator.noise();
        MatrixXd c =
            loadings_ * open.asDiagonal() * loadings_.transpose() +
            observation_.packing_share * readings_.of_specimens(noise.covariance(theta.head(parameters())));
        readings_.add(misfits_at(theta), c);
        return c;
    }

    /// Variance of each component [q] that the emulator leaves open at theta.
    VectorXd open_at(const VectorXd& theta) const {
        return trained_.emulator.predict_components(theta.head(parameters())).variance.cwiseMin(most_open_);
    }

    /// The same at a typical place between the runs.
    VectorXd typical_variance() const { return trained_.emulator.typical_variance(); }

    double emulator_variance(const VectorXd& open) const { return (loadings_.cwiseAbs2() * open).sum(); }

    /// The emulator gives the mean of T over packings. A specimen of more grains averages the curve itself
    /// over as many packings, whose T is larger by half the variance that has been averaged out (lognormal
    /// scatter; a linear T stays).
    VectorXd large_specimen(double noise_scale) const { return noise_scale * large_specimen_; }

    double log_prior(const VectorXd& theta) const {
        double sum = 0;
        for (Index k = 0; k < parameters(); ++k) sum += space_.prior(k).log_density_unit(theta[k]);
        for (Index k = 0; k < misfits(); ++k)
            sum += misfit_prior_of(k).log_density_unit(theta[parameters() + k]);
        return sum;
    }

    double log_posterior(const VectorXd& theta) const {
        const auto at = trained_.emulator.predict_components(theta.head(parameters()));
        return log_posterior(theta, at.mean, at.variance.cwiseMin(most_open_));
    }

    /// As if the emulator left `open` [q] at every theta: what is likely where it knows as much everywhere. A
    /// search by it is not drawn to where the emulator knows nothing and so excludes nothing.
    double log_representative(const VectorXd& theta, const VectorXd& open) const {
        return log_posterior(theta, trained_.emulator.predict_component_means(theta.head(parameters())),
                             open);
    }

    /// As it is expected to be, were the emulator's curve known. The estimate is sought by it: by the mean
    /// curve alone a search ends where the emulator's error flatters, by the posterior where it knows
    /// nothing.
    double log_expected(const VectorXd& theta) const {
        const auto at = trained_.emulator.predict_components(theta.head(parameters()));
        return log_density(theta, trained_.emulator.offset() + loadings_ * at.mean,
                           at.variance.cwiseMin(most_open_), observation_.packing_share, true);
    }

    /// With the mean curve [m] of `runs` direct runs at theta in place of the emulator's.
    double log_by_runs(const VectorXd& theta, const VectorXd& mean, double runs) const {
        const VectorXd none = VectorXd::Zero(loadings_.cols());
        return log_density(theta, mean, none, observation_.packing_share + 1 / runs);
    }

    /// Residuals whitened by a covariance, with the priors of the parameters as further residuals.
    void residuals(const VectorXd& x, const Eigen::LLT<MatrixXd>& factor, VectorXd& out,
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

  private:
    double log_posterior(const VectorXd& theta, const VectorXd& components, const VectorXd& open) const {
        return log_density(theta, trained_.emulator.offset() + loadings_ * components, open,
                           observation_.packing_share);
    }

    /// For a model whose mean curve [m] is known but for `open` [q], and differs from the measured specimens
    /// by `packings` times the variance of a run.
    /// `expected`: see log_expected.
    double log_density(const VectorXd& theta, const VectorXd& mean, const VectorXd& open, double packings,
                       bool expected = false) const {
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

    const TrainedEmulator& trained_;
    const ParameterSpace& space_;
    const Observation& observation_;
    ReadingNoise readings_;
    int packings_;
    VectorXd most_open_;                // [q]
    MatrixXd loadings_;                 // [m x q]
    VectorXd target_, large_specimen_;  // [m] at noise of scale 1
};

/// Refines the estimate by least squares with the covariance held at it; keeps whichever is expected to be
/// more probable.
void refine(const Likelihood& likelihood, VectorXd& theta, double& value, optimizers::Summary& summary) {
    const Index d = likelihood.parameters();
    const VectorXd known = VectorXd::Zero(likelihood.typical_variance().size());
    for (int pass = 0; pass < 3; ++pass) {
        const Eigen::LLT<MatrixXd> factor(likelihood.covariance(theta, known));
        if (factor.info() != Eigen::Success) return;
        const auto residuals = [&](const VectorXd& x, VectorXd& r, MatrixXd* jacobian) {
            likelihood.residuals(x, factor, r, jacobian);
        };
        const auto found =
            optimizers::minimise_least_squares(residuals, optimizers::unit_cube(d), theta.head(d));
        summary = found.minimum.summary;
        VectorXd candidate = theta;
        candidate.head(d) = found.minimum.x;
        const double better = likelihood.log_expected(candidate);
        if (!(better > value)) return;
        theta = candidate;
        value = better;
    }
}

optimizers::PosteriorOptions sampling_options(const Settings& settings, std::uint64_t stream) {
    optimizers::PosteriorOptions out;
    out.seed = run_seed(settings.seed, 0, stream);
    out.max_draws = settings.calibration.posterior_draws;
    out.wanted_ess = std::min(2000.0, static_cast<double>(settings.calibration.posterior_draws));
    out.max_evaluations = 300000;
    out.threads = settings.jobs;
    return out;
}

/// Some of the posterior's draws [k x n], evenly over the chains.
MatrixXd looks_at(const optimizers::Posterior& posterior) {
    const Index draws = posterior.draws.rows(), looks = std::min<Index>(draws, 200);
    MatrixXd out(looks, posterior.draws.cols());
    for (Index k = 0; k < looks; ++k) out.row(k) = posterior.draws.row(k * draws / looks);
    return out;
}

Feasibility feasibility_of(const std::vector<RunRecord>& runs, const ParameterSpace& space) {
    MatrixXd x(static_cast<Index>(runs.size()), space.dimension());
    std::vector<bool> success;
    for (const RunRecord& run : runs) {
        x.row(static_cast<Index>(success.size())) = space.unit(run.spec.parameters).transpose();
        success.push_back(run.ok);
    }
    return {x, success};
}

/// See Fit::plausible.
optimizers::Posterior plausible_posterior(const Likelihood& likelihood, const Settings& settings) {
    const VectorXd open = likelihood.typical_variance();
    const auto density = [&](const VectorXd& theta, VectorXd*) {
        return likelihood.log_representative(theta, open);
    };
    return optimizers::sample_posterior(density, optimizers::unit_cube(likelihood.dimension()),
                                        sampling_options(settings, 14));
}

/// The coordinates x [d] with the misfits' that maximise a log density, and its value there.
template <class LogDensity>
std::pair<VectorXd, double> most_probable_misfits(const Likelihood& likelihood, const VectorXd& x,
                                                  const LogDensity& log_density) {
    const Index d = likelihood.parameters(), misfits = likelihood.misfits();
    VectorXd theta(d + misfits);
    theta.head(d) = x;
    const auto negative = [&](const VectorXd& at, VectorXd*) {
        theta.tail(misfits) = at;
        return -log_density(theta);
    };
    const optimizers::Minimum found = optimizers::minimise("sbplx", negative, optimizers::unit_cube(misfits),
                                                           VectorXd::Constant(misfits, 0.5));
    theta.tail(misfits) = found.x;
    return {theta, -found.value};
}

Likelihood nearest_to_curves(const TrainedEmulator& trained, const ParameterSpace& space,
                             const Observation& observation, const Settings& settings) {
    return {trained, space, observation, settings.calibration.confirmation_packings, StrainMisfit::nearest};
}

std::pair<VectorXd, double> misfits_by_runs(const Likelihood& nearest, const TriedSet& set) {
    return most_probable_misfits(nearest, set.x, [&](const VectorXd& theta) {
        return nearest.log_by_runs(theta, set.mean, set.runs);
    });
}

}  // namespace

TrainedEmulator train_emulator(const std::vector<RunRecord>& runs, const ParameterSpace& space,
                               const std::vector<Index>& columns,
                               const std::vector<OutputTransform>& transforms, const Settings& settings) {
    const Index d = space.dimension(), m = static_cast<Index>(columns.size());
    const Index n = std::ranges::count_if(runs, [](const RunRecord& r) { return r.ok; });
    if (n < fewest_training_runs(static_cast<int>(d)))
        throw std::runtime_error(fmt::format(
            "only {} of {} runs succeeded, too few to train an emulator; the reasons stand in ensemble.h5", n,
            runs.size()));
    MatrixXd inputs(n, d), outputs(n, m);
    Index row = 0;
    for (const RunRecord& run : runs) {
        if (!run.ok) continue;
        inputs.row(row) = space.unit(run.spec.parameters).transpose();
        for (Index k = 0; k < m; ++k)
            outputs(row, k) = transforms[static_cast<std::size_t>(k)].forward(
                run.outputs[columns[static_cast<std::size_t>(k)]]);
        ++row;
    }
    surrogate::CurveEmulatorOptions options;
    options.kernel = settings.calibration.kernel;
    options.seed = run_seed(settings.seed, 0, 11);
    options.threads = settings.jobs;
    return {surrogate::CurveEmulator::fit(inputs, outputs, options), transforms, n,
            feasibility_of(runs, space)};
}

Window plausible_window(const TrainedEmulator& trained, const ParameterSpace& space,
                        const Observation& observation, const Settings& settings) {
    const Likelihood likelihood(trained, space, observation, settings.calibration.confirmation_packings);
    return window_about(plausible_posterior(likelihood, settings).draws.leftCols(likelihood.parameters()));
}

Fit fit(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation,
        const Settings& settings) {
    const Likelihood likelihood(trained, space, observation, settings.calibration.confirmation_packings);
    const Index n = likelihood.dimension(), d = likelihood.parameters();
    Fit out;
    out.plausible = plausible_posterior(likelihood, settings);
    const Window window = window_about(out.plausible.draws.leftCols(d));
    optimizers::Bounds box = optimizers::unit_cube(n);
    box.lower.head(d) = window.lower;
    box.upper.head(d) = window.upper;
    optimizers::Options options;  // of the search
    options.seed = run_seed(settings.seed, 0, 12);
    options.max_evaluations = 6000;
    options.relative_tolerance = 1e-6;
    VectorXd start(n);
    for (Index k = 0; k < d; ++k) start[k] = space.prior(k).quantile_unit(0.5);
    start.head(d) = start.head(d).cwiseMax(window.lower).cwiseMin(window.upper);
    for (Index k = d; k < n; ++k) start[k] = likelihood.misfit_prior_of(k - d).quantile_unit(0.5);

    out.posterior = optimizers::sample_posterior(
        [&](const VectorXd& t, VectorXd*) { return likelihood.log_posterior(t); }, box,
        sampling_options(settings, 13));

    const MatrixXd looks = looks_at(out.posterior);
    MatrixXd opens(looks.rows(), trained.emulator.components());
    for (Index k = 0; k < looks.rows(); ++k) {
        opens.row(k) = likelihood.open_at(looks.row(k).transpose()).transpose();
        const double emulator = likelihood.emulator_variance(opens.row(k).transpose());
        const double all = likelihood.covariance(looks.row(k).transpose(), opens.row(k).transpose()).trace();
        out.emulator_share += emulator / all / static_cast<double>(looks.rows());
    }

    const Likelihood nearest = nearest_to_curves(trained, space, observation, settings);
    const auto negative = [&](const VectorXd& theta, VectorXd*) { return -nearest.log_expected(theta); };
    const optimizers::Minimum global =
        optimizers::minimise(settings.calibration.global_optimizer, negative, box, start, options);
    out.global = global.summary;
    VectorXd theta = global.x;
    double value = -global.value;
    refine(nearest, theta, value, out.local);
    // The chains may have met a better point than the search did.
    for (Index k = 0; k < looks.rows(); ++k) {
        VectorXd other = looks.row(k).transpose();
        double there = nearest.log_expected(other);
        if (there <= value) continue;
        refine(nearest, other, there, out.local);
        theta = other;
        value = there;
    }
    // The expectation makes what is not known a misfit of the model's.
    const VectorXd known = VectorXd::Zero(trained.emulator.components());
    theta = most_probable_misfits(likelihood, theta.head(d), [&](const VectorXd& t) {
                return likelihood.log_representative(t, known);
            }).first;
    out.estimate = theta.head(d);
    out.misfits = likelihood.misfits_at(theta);
    out.log_posterior = likelihood.log_posterior(theta);
    out.covariance = likelihood.covariance(theta, likelihood.open_at(theta));
    return out;
}

std::vector<double> densities_by_runs(const std::vector<TriedSet>& sets, const TrainedEmulator& trained,
                                      const ParameterSpace& space, const Observation& observation,
                                      const Settings& settings) {
    const Likelihood nearest = nearest_to_curves(trained, space, observation, settings);
    std::vector<double> out;
    for (const TriedSet& set : sets) out.push_back(misfits_by_runs(nearest, set).second);
    return out;
}

std::size_t choose(Fit& fit, const std::vector<TriedSet>& sets, const TrainedEmulator& trained,
                   const ParameterSpace& space, const Observation& observation, const Settings& settings) {
    if (sets.empty()) throw std::invalid_argument("choose: no sets");
    const std::vector<double> densities = densities_by_runs(sets, trained, space, observation, settings);
    const auto best = static_cast<std::size_t>(std::ranges::max_element(densities) - densities.begin());
    const VectorXd theta =
        misfits_by_runs(nearest_to_curves(trained, space, observation, settings), sets[best]).first;
    const Likelihood likelihood(trained, space, observation, settings.calibration.confirmation_packings);
    fit.estimate = sets[best].x;
    fit.misfits = likelihood.misfits_at(theta);
    fit.log_posterior = likelihood.log_posterior(theta);
    fit.covariance = likelihood.covariance(theta, likelihood.open_at(theta));
    return best;
}

bool is_identified(double posterior_width, double prior_width) {
    return posterior_width < identified_below * prior_width;
}

}  // namespace loam::experiments
