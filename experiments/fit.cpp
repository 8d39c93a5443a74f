#include "experiments/fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "experiments/ensemble/run_seed.hpp"
#include "experiments/likelihood.hpp"
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

/// See Fit::near. It serves to draw a few runs from and to look once more for the estimate, which takes no
/// great accuracy.
optimizers::Posterior posterior_near(const Likelihood& nearest, const optimizers::Bounds& box,
                                     const Settings& settings) {
    optimizers::PosteriorOptions options = sampling_options(settings, 15);
    options.wanted_ess = 200;
    options.max_evaluations = 60000;
    return optimizers::sample_posterior(
        [&](const VectorXd& theta, VectorXd*) { return nearest.log_expected(theta); }, box, options);
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
    out.near = posterior_near(nearest, box, settings);
    // The chains may have met a better point than the search did.
    Index densest = 0;
    if (double there = out.near.log_density.maxCoeff(&densest); there > value) {
        theta = out.near.draws.row(densest).transpose();
        refine(nearest, theta, there, out.local);
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
