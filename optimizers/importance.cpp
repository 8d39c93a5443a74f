#include "optimizers/importance.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "optimizers/normal.hpp"
#include "optimizers/random.hpp"
#include "optimizers/require.hpp"
#include "optimizers/t_mixture.hpp"

namespace loam::optimizers {
namespace {

using Eigen::Index;

constexpr Index fitted_points = 400;  // that a mixture is fitted to
constexpr double farthest = 8;        // of |z|, where Phi is still below 1 in double precision

double log_normal(const Vector& z) {
    return -0.5 * (z.squaredNorm() + static_cast<double>(z.size()) * std::log(2 * std::numbers::pi));
}

/// Weights proportional to exp(log), sum 1.
Vector normalised(const Vector& log) {
    const double top = log.array().isFinite().select(log.array(), -INFINITY).maxCoeff();
    Vector weight = log.array().isFinite().select((log.array() - top).exp(), 0.0);
    return weight / weight.sum();
}

double effective_number(const Vector& weight) {
    return 1 / weight.squaredNorm();
}

/// The power, at most 1, that leaves at least `wanted` effective draws, or 1/1024.
double tempering_power(const Vector& log, double wanted) {
    double power = 1;
    while (power > 1e-3 && effective_number(normalised(power * log)) < wanted) power *= 0.5;
    return power;
}

/// Indices of n draws in proportion to the weights (systematic resampling; Kitagawa 1996).
std::vector<Index> resample(const Vector& weight, Index n, double offset) {
    std::vector<Index> out;
    double sum = weight[0];
    Index at = 0;
    for (Index k = 0; k < n; ++k) {
        const double want = (static_cast<double>(k) + offset) / static_cast<double>(n);
        while (sum < want && at + 1 < weight.size()) sum += weight[++at];
        out.push_back(at);
    }
    return out;
}

/// One proposal: a mixture and the standard normal, with the number of draws taken from both.
struct Proposal {
    TMixture mixture;
    double draws;
};

class Rounds {
  public:
    Rounds(const BatchDensity& density, const ImportanceOptions& options, Index d)
        : density_(density), options_(options), random_(options.seed), d_(d) {}

    /// Draws `count` points from a mixture fitted to those of `points` [d x k] that `log_weight` favours.
    void advance(const Matrix& points, const Vector& log_weight, Index count) {
        const double wanted = 8.0 * static_cast<double>(d_ + 1);
        const Vector weight = normalised(tempering_power(log_weight, wanted) * log_weight);
        const Matrix chosen =
            points(Eigen::all, resample(weight, std::min(fitted_points, points.cols()), random_.uniform()));
        proposals_.push_back({TMixture(chosen, options_.components, random_), static_cast<double>(count)});
        const Index old = z_.cols();
        z_.conservativeResize(d_, old + count);
        for (Index k = 0; k < count; ++k) z_.col(old + k) = draw(proposals_.back().mixture);
        Matrix x = z_.rightCols(count).unaryExpr([](double z) { return normal_probability(z); });
        const Vector fresh = density_(x);
        x_.conservativeResize(d_, old + count);
        x_.rightCols(count) = x;
        log_density_.conservativeResize(old + count);
        log_density_.tail(count) = fresh;
        weigh();
    }

    const Matrix& z() const { return z_; }
    const Matrix& x() const { return x_; }
    const Vector& log_density() const { return log_density_; }
    const Vector& log_weight() const { return log_weight_; }

  private:
    Vector draw(const TMixture& mixture) {
        Vector z(d_);
        if (random_.uniform() < options_.defensive)
            for (double& entry : z) entry = random_.normal();
        else
            z = mixture.draw(random_);
        return z.cwiseMax(-farthest).cwiseMin(farthest);
    }

    void weigh() {
        double total = 0;
        for (const Proposal& p : proposals_) total += p.draws;
        const double constant = TMixture::log_constant(d_);
        log_weight_.resize(z_.cols());
        for (Index k = 0; k < z_.cols(); ++k) {
            const Vector z = z_.col(k);
            const double normal = log_normal(z);
            double sum = options_.defensive * std::exp(normal);
            for (const Proposal& p : proposals_)
                sum += (1 - options_.defensive) * p.draws / total *
                       std::exp(p.mixture.log_density(z) + constant);
            log_weight_[k] = log_density_[k] + normal - std::log(sum);
        }
    }

    const BatchDensity& density_;
    const ImportanceOptions& options_;
    Random random_;
    Index d_;
    std::vector<Proposal> proposals_;
    Matrix z_, x_;
    Vector log_density_, log_weight_;
};

}  // namespace

void ImportanceOptions::validate() const {
    const auto check = [](bool holds, const char* field, auto value, const std::string& constraint) {
        require(holds, "ImportanceOptions", field, value, constraint);
    };
    check(rounds >= 1, "rounds", rounds, "at least 1");
    check(most_rounds >= rounds, "most_rounds", most_rounds, "at least rounds");
    check(wanted > 1, "wanted", wanted, "above 1");
    check(draws >= 50, "draws", draws, "at least 50");
    check(last_draws >= 50, "last_draws", last_draws, "at least 50");
    check(components >= 1, "components", components, "at least 1");
    check(defensive > 0 && defensive < 1, "defensive", defensive, "between 0 and 1");
}

Matrix WeightedDraws::resampled(Index n) const {
    return draws(resample(weight, n, 0.5), Eigen::all);
}

WeightedDraws sample_by_importance(const BatchDensity& log_density, const Matrix& first,
                                   const Vector& first_log_weight, const ImportanceOptions& options) {
    const auto began = std::chrono::steady_clock::now();
    options.validate();
    if (first.cols() < 2 || first.cols() != first_log_weight.size())
        throw std::invalid_argument("importance sampling: first points and their weights differ in number");
    if (!first_log_weight.array().isFinite().any())
        throw std::invalid_argument("importance sampling: no first point has a finite weight");
    Rounds rounds(log_density, options, first.rows());
    const Matrix z =
        first.unaryExpr([](double x) { return normal_quantile(std::clamp(x, 1e-12, 1 - 1e-12)); });
    const auto is_enough = [&] {
        return effective_number(normalised(rounds.log_weight())) >= options.wanted;
    };
    int round = 0;
    for (; round < options.rounds || (round < options.most_rounds && !is_enough()); ++round) {
        const Index count = round + 1 >= options.rounds ? options.last_draws : options.draws;
        if (round == 0)
            rounds.advance(z, first_log_weight, count);
        else
            rounds.advance(Matrix(rounds.z()), Vector(rounds.log_weight()), count);
        if (!rounds.log_weight().array().isFinite().any())
            throw std::runtime_error("importance sampling: the density is finite at no draw");
    }
    WeightedDraws out;
    out.draws = rounds.x().transpose();
    out.weight = normalised(rounds.log_weight());
    out.log_density = rounds.log_density();
    out.effective = effective_number(out.weight);
    out.summary.converged = out.effective >= options.wanted;
    out.summary.stopped_by =
        out.summary.converged ? "as many effective draws as wanted" : "the most rounds allowed";
    out.summary.evaluations = static_cast<int>(out.draws.rows());
    out.summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return out;
}

}  // namespace loam::optimizers
