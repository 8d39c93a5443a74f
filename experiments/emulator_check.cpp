#include "experiments/emulator_check.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <numeric>

#include "experiments/cross_test.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/quantile.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double allowed_shift = 0.5;     // of the posterior's standard deviation
constexpr double most_by_chance = 2;      // beyond that the runs are too few to tell anything
constexpr double chance_in_errors = 2.5;  // standard errors: 3 % a parameter, of 12 runs (Student's t)
constexpr double decisive = 4.6;          // in log density: 100:1
constexpr std::size_t most_in_question = 3;
constexpr std::uint64_t draw_stream = 4;  // of run_seed

/// Variance [m] of the mean of the rows of a [n x m].
VectorXd variance_of_mean(const MatrixXd& a) {
    const double n = static_cast<double>(a.rows());
    const MatrixXd centred = a.rowwise() - a.colwise().mean();
    return centred.colwise().squaredNorm().transpose() / std::max(1.0, n - 1) / n;
}

/// The largest rms difference of a curve, over what is tolerable and the noise of the runs' mean together.
double largest_difference(const TrainedEmulator& trained, const Observation& observation,
                          const VectorXd& emulated, const MatrixXd& direct) {
    const VectorXd mean = direct.colwise().mean().transpose(), variance = variance_of_mean(direct);
    double largest = 0;
    for (const ObservedCurve& curve : curves_of(observation)) {
        double squares = 0, noise = 0;
        for (Index k = curve.first; k < curve.first + curve.count; ++k) {
            const OutputTransform& transform = trained.transforms[static_cast<std::size_t>(k)];
            const double y = transform.inverse(mean[k]);
            squares += std::pow(y - transform.inverse(emulated[k]), 2);
            noise += variance[k] / std::pow(transform.derivative(y), 2);
        }
        const double n = static_cast<double>(curve.count),
                     tolerable = curve.unit * curve.tolerable_difference;
        largest = std::max(largest, std::sqrt(squares / n / (tolerable * tolerable + noise / n)));
    }
    return largest;
}

}  // namespace

MatrixXd transformed_curves(const std::vector<RunRecord>& runs, const std::vector<Index>& columns,
                            const std::vector<OutputTransform>& transforms) {
    MatrixXd out(std::ranges::count_if(runs, &RunRecord::ok), static_cast<Index>(columns.size()));
    Index row = 0;
    for (const RunRecord& run : runs) {
        if (!run.ok) continue;
        for (Index k = 0; k < out.cols(); ++k)
            out(row, k) = transforms[static_cast<std::size_t>(k)].forward(
                run.outputs[columns[static_cast<std::size_t>(k)]]);
        ++row;
    }
    return out;
}

Index outside_posterior(const Fit& fit, double central) {
    const double tail = 0.5 * (1 - central);
    for (Index k = 0; k < fit.estimate.size(); ++k) {
        const VectorXd draws = fit.posterior.draws.col(k);
        const std::vector<double> values(draws.begin(), draws.end());
        if (fit.estimate[k] < quantile(values, tail) || fit.estimate[k] > quantile(values, 1 - tail))
            return k;
    }
    return -1;
}

bool is_sure(const Fit& fit) {
    return fit.emulator_share <= tolerable_share && outside_posterior(fit) < 0;
}

Index bring_to_estimate(Fit& fit) {
    const Index apart = is_sure(fit) ? -1 : outside_posterior(fit, reported_interval);
    if (apart >= 0) fit.posterior = fit.plausible;
    return apart;
}

std::vector<std::size_t> in_question(const std::vector<double>& densities) {
    std::vector<std::size_t> out(densities.size());
    std::iota(out.begin(), out.end(), 0);
    std::ranges::sort(out, std::greater<>(), [&](std::size_t k) { return densities[k]; });
    const auto settled = std::ranges::find_if(
        out, [&](std::size_t k) { return densities[k] < densities[out.front()] - decisive; });
    out.resize(std::min(most_in_question, static_cast<std::size_t>(settled - out.begin())));
    return out;
}

MatrixXd sets_to_add(const Fit& fit, int whole, bool follows, std::uint64_t seed, std::uint64_t first) {
    int posterior = whole, all = whole;  // of the runs
    if (outside_posterior(fit) >= 0) {
        posterior = follows ? std::min(whole, 2) : (whole + 3) / 4;
        if (follows) all = posterior;
    } else if (!is_sure(fit)) {
        posterior = (whole + 2) / 3;
    }
    MatrixXd out(all, fit.estimate.size());
    for (int k = 0; k < all; ++k) {
        const MatrixXd& others = (k - posterior) % 2 == 0 ? fit.near.draws : fit.plausible.draws;
        const MatrixXd& draws = k < posterior ? fit.posterior.draws : others;
        const std::uint64_t number = run_seed(seed, first + static_cast<std::uint64_t>(k), draw_stream);
        const auto row = static_cast<Index>(number % static_cast<std::uint64_t>(draws.rows()));
        out.row(k) = draws.row(row).head(out.cols());
    }
    return out;
}

EmulatorCheck check_emulator(const Fit& fit, const TrainedEmulator& trained, const Observation& observation,
                             const MatrixXd& direct) {
    MatrixXd slope;
    const VectorXd emulated = trained.emulator.predict_mean(fit.estimate, &slope);
    const MatrixXd covariance = gaussian_of(fit, fit.estimate.size()).covariance;
    const VectorXd sd = covariance.diagonal().cwiseSqrt();
    const MatrixXd pull = covariance * fit.covariance.ldlt().solve(slope).transpose();      // [d x m]
    const MatrixXd shifts = -(direct.rowwise() - emulated.transpose()) * pull.transpose();  // [n x d]
    const VectorXd mean = shifts.colwise().mean().transpose(), error = variance_of_mean(shifts).cwiseSqrt();
    EmulatorCheck out;
    out.difference = largest_difference(trained, observation, emulated, direct);
    for (Index k = 0; k < sd.size(); ++k) {
        if (!(sd[k] > 0)) continue;
        const double shift = std::abs(mean[k]) / sd[k];
        const double limit = std::clamp(chance_in_errors * error[k] / sd[k], allowed_shift, most_by_chance);
        if (shift / limit <= out.shift / out.limit) continue;
        out.shift = shift;
        out.limit = limit;
        out.parameter = k;
    }
    return out;
}

}  // namespace loam::experiments
