#include "optimizers/posterior.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "optimizers/mcmc_diagnostics.hpp"
#include "optimizers/posterior_kernel.hpp"
#include "optimizers/require.hpp"
#include "optimizers/tempering.hpp"

namespace loam::optimizers {

namespace {

constexpr std::size_t largest_archive = 1000;
constexpr int most_components = 16;
constexpr int most_lessons = 3;
constexpr std::size_t least_sweeps = 10;  // whatever the time: R-hat and effective sizes need some draws

int particles_for(Eigen::Index k) {
    return static_cast<int>(std::max<Eigen::Index>(200, 40 * k));
}

class Sampler {
  public:
    Sampler(const Objective& log_density, const Bounds& bounds, const PosteriorOptions& options)
        : options_(options),
          bounds_(bounds),
          target_(log_density, bounds, options.threads),
          random_(options.seed) {}

    Posterior run();

  private:
    bool out_of_evaluations() const {
        return target_.evaluations() + options_.chains > options_.max_evaluations;
    }
    bool out_of_time(double part = 1) const {
        return options_.max_seconds > 0 && seconds() >= part * options_.max_seconds;
    }
    bool spent() const { return out_of_evaluations() || (out_of_time() && sweeps() >= least_sweeps); }
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    }
    std::size_t sweeps() const { return draws_.size() / chains_.size(); }

    void begin();
    std::vector<std::size_t> thinned(std::size_t most) const;
    void learn(const std::vector<ChainState>& archive, const Shares& shares);
    void learn_from_draws();
    void take_draws(double count);
    bool satisfied() const;
    bool worth_another_lesson() const;
    double least_ess() const { return std::min(result_.ess_bulk.minCoeff(), result_.ess_tail.minCoeff()); }
    Matrix chains_of(Eigen::Index variable) const;
    void assess();
    void hand_over();

    const PosteriorOptions options_;
    const Bounds bounds_;
    CubeTarget target_;
    Random random_;
    std::unique_ptr<const Kernel> kernel_;
    std::vector<ChainState> chains_;
    std::vector<std::size_t> at_;      // where in visited_ they are
    std::vector<ChainState> visited_;  // since the last lesson
    std::vector<std::size_t> draws_;   // sweep after sweep, which of visited_ each chain was at
    Tally tally_;                      // likewise
    int lessons_ = 0;
    Posterior result_;
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

void Sampler::begin() {
    const int size = particles_for(target_.size());
    const auto half_spent = [this] {
        return target_.evaluations() >= options_.max_evaluations / 2 || out_of_time(0.5);
    };
    const WarmUp warm = warm_up(target_, size, half_spent, random_);
    for (int i = 0; i < options_.chains; ++i) {
        chains_.push_back(warm.particles[static_cast<std::size_t>(random_.index(size))]);
    }
    learn(warm.particles, warm.shares);
}

void Sampler::learn(const std::vector<ChainState>& archive, const Shares& shares) {
    kernel_ = std::make_unique<const Kernel>(target_, archive, most_components, shares, random_);
    for (ChainState& chain : chains_) chain.log_proposal_u = chain.log_proposal_z = std::nullopt;
    tally_ = {};
    draws_.clear();
    visited_ = chains_;
    at_.resize(chains_.size());
    std::iota(at_.begin(), at_.end(), std::size_t{0});
    ++lessons_;
    result_.warmup_evaluations = target_.evaluations();
}

/// Indices of `most` draws at the most, whole sweeps evenly apart, so that every chain has its share.
std::vector<std::size_t> Sampler::thinned(std::size_t most) const {
    const std::size_t chains = chains_.size(), kept = std::clamp<std::size_t>(most / chains, 1, sweeps());
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < kept; ++i) {
        for (std::size_t j = 0; j < chains && chosen.size() < most; ++j) {
            chosen.push_back(i * sweeps() / kept * chains + j);
        }
    }
    return chosen;
}

void Sampler::learn_from_draws() {
    std::vector<ChainState> archive;
    for (const std::size_t i : thinned(largest_archive)) archive.push_back(visited_[draws_[i]]);
    learn(archive, tally_.shares());
}

void Sampler::take_draws(double count) {
    const std::size_t wanted = draws_.size() + static_cast<std::size_t>(count);
    while (draws_.size() < wanted && !spent()) {
        const std::vector<bool> moved = kernel_->sweep(chains_, 1, random_, tally_);
        for (std::size_t i = 0; i < chains_.size(); ++i) {
            if (moved[i]) {
                at_[i] = visited_.size();
                visited_.push_back(chains_[i]);
            }
            draws_.push_back(at_[i]);
        }
    }
}

bool Sampler::satisfied() const {
    return result_.rhat.maxCoeff() < options_.max_rhat && least_ess() >= options_.wanted_ess;
}

/// The draws so far are given up for a better kernel where the chains disagree, or where to go on would cost
/// more than to begin again with one that gives an effective draw for four evaluations; if there is room to
/// fail.
bool Sampler::worth_another_lesson() const {
    const double cost = target_.evaluations() - result_.warmup_evaluations;
    const double missing = cost * (options_.wanted_ess / least_ess() - 1);
    const bool poor = result_.rhat.maxCoeff() > 1.05 || missing > 4 * options_.wanted_ess;
    const bool room = target_.evaluations() + 3 * cost < options_.max_evaluations && !out_of_time(0.5);
    return lessons_ <= most_lessons && poor && room;
}

/// Draws of one variable [sweeps x chains], thinned when there are many more than are needed to see that they
/// suffice.
Matrix Sampler::chains_of(Eigen::Index variable) const {
    const std::vector<std::size_t> chosen = thinned(static_cast<std::size_t>(4 * options_.wanted_ess));
    const auto chains = static_cast<Eigen::Index>(chains_.size());
    Matrix values(static_cast<Eigen::Index>(chosen.size()) / chains, chains);
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
        for (Eigen::Index j = 0; j < chains; ++j) {
            values(i, j) = visited_[draws_[chosen[static_cast<std::size_t>(i * chains + j)]]].x(variable);
        }
    }
    return values;
}

void Sampler::assess() {
    const Eigen::Index d = bounds_.size();
    result_.rhat.setConstant(d, 1);
    result_.ess_bulk.setConstant(d, static_cast<double>(draws_.size()));
    result_.ess_tail = result_.ess_bulk;
    for (Eigen::Index i = 0; i < d; ++i) {
        if (bounds_.lower(i) == bounds_.upper(i)) continue;
        const Matrix chains = chains_of(i);
        // NaN: no chain has moved, so that there is one draw and nothing to show that they agree.
        const double rhat = split_rhat(chains), bulk = bulk_effective_size(chains),
                     tail = tail_effective_size(chains);
        result_.rhat(i) = std::isnan(rhat) ? std::numeric_limits<double>::infinity() : rhat;
        result_.ess_bulk(i) = std::isnan(bulk) ? 1 : bulk;
        result_.ess_tail(i) = std::isnan(tail) ? 1 : tail;
    }
}

void Sampler::hand_over() {
    const std::vector<std::size_t> kept = thinned(static_cast<std::size_t>(options_.max_draws));
    result_.draws.resize(static_cast<Eigen::Index>(kept.size()), bounds_.size());
    result_.log_density.resize(result_.draws.rows());
    for (Eigen::Index i = 0; i < result_.draws.rows(); ++i) {
        const ChainState& state = visited_[draws_[kept[static_cast<std::size_t>(i)]]];
        result_.draws.row(i) = state.x.transpose();
        result_.log_density(i) = state.log_density;
    }
    result_.mean.setZero(bounds_.size());
    for (const std::size_t i : draws_) result_.mean += visited_[i].x;
    const auto total = static_cast<double>(draws_.size());
    result_.mean /= total;
    Vector squares = Vector::Zero(bounds_.size());
    for (const std::size_t i : draws_) squares += (visited_[i].x - result_.mean).cwiseAbs2();
    result_.sd = (squares / (total - 1)).cwiseSqrt();
    result_.acceptance = tally_.accepted / tally_.steps;
    result_.summary.evaluations = target_.evaluations();
}

Posterior Sampler::run() {
    begin();
    // The first guess is two effective draws out of three; after that the rate is known.
    const double first = 1.5 * options_.wanted_ess;
    for (double more = first;;) {
        take_draws(more);
        assess();
        result_.summary.converged = satisfied();
        if (result_.summary.converged || spent()) break;
        const auto taken = static_cast<double>(draws_.size());
        more = taken * std::clamp(1.1 * options_.wanted_ess / least_ess() - 1, 0.1, 2.0);
        if (worth_another_lesson()) {
            learn_from_draws();
            more = first;
        }
    }
    hand_over();
    Summary& summary = result_.summary;
    summary.seconds = seconds();
    summary.stopped_by = summary.converged      ? "R-hat and effective sizes are as wanted"
                         : out_of_evaluations() ? "max_evaluations reached"
                                                : "max_seconds reached";
    return result_;
}

}  // namespace

void PosteriorOptions::validate(Eigen::Index d) const {
    const auto check = [](bool holds, const char* field, auto value, const std::string& constraint) {
        require(holds, "PosteriorOptions", field, value, constraint);
    };
    check(chains >= 2, "chains", chains, "at least 2");
    check(wanted_ess >= 10 * chains, "wanted_ess", wanted_ess, "at least 10 per chain");
    check(max_rhat > 1 && max_rhat < 2, "max_rhat", max_rhat, "between 1 and 2");
    check(max_evaluations >= 20 * particles_for(d), "max_evaluations", max_evaluations,
          "at least " + std::to_string(20 * particles_for(d)) + " for " + std::to_string(d) + " variables");
    check(max_evaluations >= 100 * chains, "max_evaluations", max_evaluations, "at least 100 per chain");
    check(max_seconds >= 0, "max_seconds", max_seconds, "at least 0 (0: no limit)");
    check(threads >= 0, "threads", threads, "at least 0 (0: as OpenMP says)");
    check(max_draws >= 1, "max_draws", max_draws, "at least 1");
}

Posterior sample_posterior(const Objective& log_density, const Bounds& bounds,
                           const PosteriorOptions& options) {
    bounds.validate();
    options.validate(bounds.size());
    if (bounds.lower == bounds.upper) {
        throw std::invalid_argument(
            "optimizers: no posterior, because every variable is fixed by its bounds");
    }
    return Sampler(log_density, bounds, options).run();
}

}  // namespace loam::optimizers
