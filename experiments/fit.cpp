#include "experiments/fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/likelihood_terms.hpp"
#include "experiments/settings/validation.hpp"
#include "optimizers/least_squares.hpp"
#include "optimizers/registry.hpp"
#include "surrogate/kernels/registry.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double identified_below = 0.75;  // posterior over prior width

class Likelihood {
  public:
    Likelihood(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation)
        : trained_(trained),
          space_(space),
          observation_(observation),
          readings_(observation, trained.transforms) {
        const Index m = observation.measured.size();
        target_.resize(m);
        for (Index k = 0; k < m; ++k) target_[k] = transform(k).forward(observation.measured[k]);
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

    MatrixXd covariance(const VectorXd& theta, double* emulator_variance = nullptr,
                        VectorXd* mean = nullptr) const {
        const surrogate::CurvePrediction at = trained_.emulator.predict(theta.head(parameters()));
        if (emulator_variance) *emulator_variance = at.emulator_covariance.trace();
        if (mean) *mean = at.mean + large_specimen(at.noise_covariance);
        MatrixXd c =
            at.emulator_covariance + observation_.packing_share * readings_.of_specimens(at.noise_covariance);
        readings_.add(misfits_at(theta), c);
        return c;
    }

    /// The emulator gives the mean of T over packings. A specimen of more grains averages the curve itself
    /// over as many packings, whose T is larger by half the variance that has been averaged out (lognormal
    /// scatter; a linear T stays).
    VectorXd large_specimen(const MatrixXd& packing_noise) const {
        VectorXd out = 0.5 * (1 - std::min(1.0, observation_.packing_share)) * packing_noise.diagonal();
        for (Index k = 0; k < out.size(); ++k)
            if (transform(k).linear) out[k] = 0;
        return out;
    }

    double log_prior(const VectorXd& theta) const {
        double sum = 0;
        for (Index k = 0; k < parameters(); ++k) sum += space_.prior(k).log_density_unit(theta[k]);
        for (Index k = 0; k < misfits(); ++k)
            sum += misfit_prior_of(k).log_density_unit(theta[parameters() + k]);
        return sum;
    }

    double log_posterior(const VectorXd& theta) const {
        VectorXd mean;
        const Eigen::LLT<MatrixXd> factor(covariance(theta, nullptr, &mean));
        if (factor.info() != Eigen::Success) return -INFINITY;
        const VectorXd white = factor.matrixL().solve(target_ - mean);
        const double log_det = 2 * factor.matrixL().toDenseMatrix().diagonal().array().log().sum();
        return -0.5 * (white.squaredNorm() + log_det) + log_prior(theta) +
               trained_.feasibility.log_success(theta.head(parameters()));
    }

    /// Residuals whitened by a covariance, with the priors of the parameters as further residuals.
    void residuals(const VectorXd& x, const Eigen::LLT<MatrixXd>& factor, VectorXd& out,
                   MatrixXd* jacobian) const {
        const Index m = target_.size(), d = parameters();
        MatrixXd slope;
        const VectorXd mean = trained_.emulator.predict_mean(x, jacobian ? &slope : nullptr) +
                              large_specimen(trained_.emulator.noise().covariance(x));
        out.resize(m + d);
        out.head(m) = factor.matrixL().solve(target_ - mean);
        if (jacobian) {
            jacobian->setZero(m + d, d);
            jacobian->topRows(m) = -factor.matrixL().solve(slope);
        }
        prior_residuals(space_, x, m, out, jacobian);
    }

  private:
    const OutputTransform& transform(Index k) const {
        return trained_.transforms[static_cast<std::size_t>(k)];
    }

    const TrainedEmulator& trained_;
    const ParameterSpace& space_;
    const Observation& observation_;
    ReadingNoise readings_;
    VectorXd target_;
};

/// Refines the estimate by least squares with the covariance held at it; keeps whichever is more probable.
void refine(const Likelihood& likelihood, VectorXd& theta, double& value, optimizers::Summary& summary) {
    const Index d = likelihood.parameters();
    for (int pass = 0; pass < 3; ++pass) {
        const Eigen::LLT<MatrixXd> factor(likelihood.covariance(theta));
        if (factor.info() != Eigen::Success) return;
        const auto residuals = [&](const VectorXd& x, VectorXd& r, MatrixXd* jacobian) {
            likelihood.residuals(x, factor, r, jacobian);
        };
        const auto found =
            optimizers::minimise_least_squares(residuals, optimizers::unit_cube(d), theta.head(d));
        summary = found.minimum.summary;
        VectorXd candidate = theta;
        candidate.head(d) = found.minimum.x;
        const double better = likelihood.log_posterior(candidate);
        if (!(better > value)) return;
        theta = candidate;
        value = better;
    }
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

Fit fit(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation,
        const Settings& settings) {
    const Likelihood likelihood(trained, space, observation);
    const Index n = likelihood.dimension(), d = likelihood.parameters();
    const optimizers::Bounds box = optimizers::unit_cube(n);
    optimizers::Options options;
    options.seed = run_seed(settings.seed, 0, 12);
    options.max_evaluations = 6000;
    options.relative_tolerance = 1e-6;
    const auto negative = [&](const VectorXd& theta, VectorXd*) { return -likelihood.log_posterior(theta); };
    VectorXd start(n);
    for (Index k = 0; k < d; ++k) start[k] = space.prior(k).quantile_unit(0.5);
    for (Index k = d; k < n; ++k) start[k] = likelihood.misfit_prior_of(k - d).quantile_unit(0.5);

    Fit out;
    const optimizers::Minimum global =
        optimizers::minimise(settings.calibration.global_optimizer, negative, box, start, options);
    out.global = global.summary;
    VectorXd theta = global.x;
    double value = -global.value;
    refine(likelihood, theta, value, out.local);

    optimizers::PosteriorOptions sampling;
    sampling.seed = run_seed(settings.seed, 0, 13);
    sampling.max_draws = settings.calibration.posterior_draws;
    sampling.wanted_ess = std::min(2000.0, static_cast<double>(settings.calibration.posterior_draws));
    sampling.max_evaluations = 300000;
    out.posterior = optimizers::sample_posterior(
        [&](const VectorXd& t, VectorXd*) { return likelihood.log_posterior(t); }, box, sampling);
    // The chains may have met a better point than the search did.
    Index best = 0;
    if (out.posterior.log_density.maxCoeff(&best) > value) {
        theta = out.posterior.draws.row(best).transpose();
        value = out.posterior.log_density[best];
        refine(likelihood, theta, value, out.local);
    }
    out.estimate = theta.head(d);
    out.misfits = likelihood.misfits_at(theta);
    out.log_posterior = value;
    out.covariance = likelihood.covariance(theta);
    // Where the posterior has two hills, the estimate stands on one of them only.
    const Index draws = out.posterior.draws.rows(), looks = std::min<Index>(draws, 200);
    for (Index k = 0; k < looks; ++k) {
        double emulator = 0;
        const VectorXd draw = out.posterior.draws.row(k * draws / looks).transpose();
        const double all = likelihood.covariance(draw, &emulator).trace();
        out.emulator_share += emulator / all / static_cast<double>(looks);
    }
    return out;
}

bool is_identified(double posterior_width, double prior_width) {
    return posterior_width < identified_below * prior_width;
}

double quantile(std::vector<double> values, double q) {
    if (values.empty()) throw std::invalid_argument("quantile: no values");
    std::ranges::sort(values);
    const double at = q * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(at);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

}  // namespace loam::experiments
