#include "experiments/diagnosis/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "experiments/quantile.hpp"
#include "optimizers/least_squares.hpp"
#include "optimizers/random.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int bootstrap_draws = 2000;

std::vector<Index> others(Index m, const std::vector<Index>& left_out) {
    std::vector<Index> out;
    for (Index k = 0; k < m; ++k)
        if (std::ranges::find(left_out, k) == left_out.end()) out.push_back(k);
    return out;
}

HeldOutScore score(const FittedModel& model, const HeldOutGroup& group, const VectorXd& x) {
    MatrixXd jacobian;
    const VectorXd error = (model.measured - model.curve(x, &jacobian))(group.outputs);
    const std::vector<Index> used = others(model.measured.size(), group.outputs);
    const MatrixXd seen = jacobian(used, Eigen::all), there = jacobian(group.outputs, Eigen::all);
    const MatrixXd information = seen.transpose() * model.noise(used, used).ldlt().solve(seen) +
                                 MatrixXd(model.prior_sd.cwiseAbs2().cwiseInverse().asDiagonal());
    const MatrixXd noise = model.noise(group.outputs, group.outputs);
    const Eigen::LLT<MatrixXd> spread(noise + there * information.ldlt().solve(there.transpose()));
    const VectorXd white = spread.matrixL().solve(error);
    const double log_det = 2 * spread.matrixL().toDenseMatrix().diagonal().array().log().sum();
    const auto n = static_cast<double>(error.size());
    return {group.name, -0.5 * (white.squaredNorm() + log_det + n * std::log(2 * std::numbers::pi)),
            (error.array().square() / noise.diagonal().array()).sum(), error.size()};
}

double mean_square(const std::vector<HeldOutScore>& scores, const std::vector<std::size_t>& drawn) {
    double squares = 0, count = 0;
    for (const std::size_t k : drawn) {
        squares += scores[k].squares;
        count += static_cast<double>(scores[k].outputs);
    }
    return count > 0 ? squares / count : 0.0;
}

double gap_of(const std::vector<HeldOutScore>& scores, const std::vector<std::size_t>& drawn) {
    return std::sqrt(std::max(0.0, mean_square(scores, drawn) - 1));
}

std::vector<std::size_t> all_of(const std::vector<HeldOutScore>& scores) {
    std::vector<std::size_t> out(scores.size());
    std::iota(out.begin(), out.end(), std::size_t{0});
    return out;
}

}  // namespace

VectorXd most_probable(const FittedModel& model, const std::vector<Index>& outputs, const VectorXd& start) {
    const std::vector<Index> used = outputs.empty() ? others(model.measured.size(), {}) : outputs;
    const Eigen::LLT<MatrixXd> factor(MatrixXd(model.noise(used, used)));
    const auto m = static_cast<Index>(used.size()), d = model.prior_sd.size();
    const auto residuals = [&](const VectorXd& x, VectorXd& r, MatrixXd* jacobian) {
        MatrixXd slope;
        const VectorXd curve = model.curve(x, jacobian ? &slope : nullptr);
        r.resize(m + d);
        r.head(m) = factor.matrixL().solve(VectorXd((model.measured - curve)(used)));
        r.tail(d) = (x - model.prior_mean).cwiseQuotient(model.prior_sd);
        if (!jacobian) return;
        jacobian->setZero(m + d, d);
        jacobian->topRows(m) = -factor.matrixL().solve(MatrixXd(slope(used, Eigen::all)));
        jacobian->bottomRows(d) = model.prior_sd.cwiseInverse().asDiagonal();
    };
    const auto box = optimizers::unit_cube(d);
    optimizers::Minimum best = optimizers::minimise_least_squares(residuals, box, start).minimum;
    const optimizers::Minimum other =
        optimizers::minimise_least_squares(residuals, box, model.prior_mean).minimum;
    return other.value < best.value ? other.x : best.x;
}

LinearModel linearised(const FittedModel& model, const VectorXd& x) {
    LinearModel out;
    const VectorXd curve = model.curve(x, &out.jacobian);
    out.residual = model.measured - curve + out.jacobian * (x - model.prior_mean);
    out.noise = model.noise;
    out.prior_sd = model.prior_sd;
    return out;
}

std::vector<HeldOutScore> predict_held_out(const FittedModel& model, const std::vector<HeldOutGroup>& groups,
                                           const VectorXd& start) {
    std::vector<HeldOutScore> out;
    for (const HeldOutGroup& group : groups)
        out.push_back(
            score(model, group, most_probable(model, others(model.measured.size(), group.outputs), start)));
    return out;
}

double error_over_noise(const std::vector<HeldOutScore>& scores) {
    return std::sqrt(mean_square(scores, all_of(scores)));
}

double gap(const std::vector<HeldOutScore>& scores) {
    return gap_of(scores, all_of(scores));
}

double shrink_of(double before, double after) {
    // A gap that was none cannot have grown by more than all of itself.
    return before > 0 ? std::max(-1.0, 1 - after / before) : after > 0 ? -1 : 0;
}

GapInterval gap_interval(const std::vector<HeldOutScore>& before, const std::vector<HeldOutScore>& after,
                         std::uint64_t seed) {
    optimizers::Random random(seed);
    std::vector<double> old(bootstrap_draws), now(bootstrap_draws), shrink(bootstrap_draws);
    std::vector<std::size_t> drawn(before.size());
    for (std::size_t k = 0; k < old.size(); ++k) {
        for (std::size_t& at : drawn)
            at = static_cast<std::size_t>(random.index(static_cast<std::int64_t>(before.size())));
        old[k] = gap_of(before, drawn);
        now[k] = gap_of(after, drawn);
        shrink[k] = shrink_of(old[k], now[k]);
    }
    return {quantile(old, 0.05), quantile(old, 0.95),    quantile(now, 0.05),
            quantile(now, 0.95), quantile(shrink, 0.05), quantile(shrink, 0.95)};
}

}  // namespace loam::experiments
