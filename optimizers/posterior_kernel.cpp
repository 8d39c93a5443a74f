#include "optimizers/posterior_kernel.hpp"

#include <omp.h>

#include <atomic>
#include <cmath>
#include <exception>
#include <numeric>

#include "optimizers/normal.hpp"

namespace loam::optimizers {

namespace {

Matrix columns(const std::vector<ChainState>& states, Vector ChainState::*member) {
    Matrix matrix((states.front().*member).size(), static_cast<Eigen::Index>(states.size()));
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
        matrix.col(j) = states[static_cast<std::size_t>(j)].*member;
    return matrix;
}

Matrix covariance_root(const Matrix& points) {
    const Matrix centred = points.colwise() - points.rowwise().mean();
    Matrix covariance = centred * centred.transpose() / static_cast<double>(points.cols() - 1);
    covariance.diagonal() += 1e-6 * covariance.diagonal() + Vector::Constant(points.rows(), 1e-30);
    return covariance.llt().matrixL();
}

bool inside_cube(const Vector& u) {
    return (u.array() > 0).all() && (u.array() < 1).all();
}

}  // namespace

CubeTarget::CubeTarget(const Objective& log_density, const Bounds& bounds, int threads)
    : log_density_(log_density), box_(bounds), threads_(threads > 0 ? threads : omp_get_max_threads()) {}

bool CubeTarget::place_u(const Vector& u, ChainState& state) {
    if (!inside_cube(u)) return false;
    state.u = u;
    state.z = u.unaryExpr([](double value) { return normal_quantile(value); });
    return true;
}

bool CubeTarget::place_z(const Vector& z, ChainState& state) {
    state.z = z;
    state.u = z.unaryExpr([](double value) { return normal_probability(value); });
    return inside_cube(state.u);
}

void CubeTarget::evaluate(std::span<ChainState* const> states) {
    const int count = static_cast<int>(states.size());
    std::exception_ptr thrown;
    std::atomic<bool> ended = false;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads_)
    for (int i = 0; i < count; ++i) {
        if (ended) continue;
        ChainState& state = *states[static_cast<std::size_t>(i)];
        try {
            state.x = box_.to_x(state.u);
            state.log_density = log_density_(state.x, nullptr);
        } catch (...) {
            if (!ended.exchange(true)) thrown = std::current_exception();
        }
    }
    if (thrown) std::rethrow_exception(thrown);
    evaluations_ += count;
}

double Tally::total_jumped() const {
    return std::accumulate(jumped.begin(), jumped.end(), 0.0);
}

Shares Tally::shares() const {
    Shares worth{};
    for (std::size_t i = 0; i < move_count; ++i) worth[i] = jumped[i] / std::max(1.0, cost[i]);
    const double sum = std::accumulate(worth.begin(), worth.end(), 0.0);
    constexpr double least = 0.03;
    for (double& share : worth) {
        share = least + (1 - move_count * least) * (sum > 0 ? share / sum : 1.0 / move_count);
    }
    return worth;
}

Kernel::Kernel(CubeTarget& target, const std::vector<ChainState>& archive, int components,
               const Shares& shares, Random& random)
    : target_(target),
      shares_(shares),
      u_(columns(archive, &ChainState::u)),
      z_(columns(archive, &ChainState::z)),
      root_z_(covariance_root(z_)),
      mixture_u_(u_, components, random),
      mixture_z_(z_, components, random) {}

Vector Kernel::difference(const Matrix& archive, Random& random) const {
    const Eigen::Index a = random.index(archive.cols());
    Eigen::Index b = random.index(archive.cols() - 1);
    if (b >= a) ++b;
    return archive.col(a) - archive.col(b);
}

bool Kernel::place(const ChainState& state, Proposal& proposal, Random& random) const {
    // The length that is best for a normal density (ter Braak 2006), spread to suit others.
    const double length =
        2.38 / std::sqrt(2.0 * static_cast<double>(target_.size())) * (0.5 + random.uniform());
    switch (proposal.move) {
        case difference_u:
            return CubeTarget::place_u(state.u + length * difference(u_, random), proposal.state);
        case difference_z:
            return CubeTarget::place_z(state.z + length * difference(z_, random), proposal.state);
        case jump_u:
            return CubeTarget::place_u(state.u + difference(u_, random), proposal.state);
        case independent_u:
            return CubeTarget::place_u(mixture_u_.draw(random), proposal.state);
        case independent_z:
            return CubeTarget::place_z(mixture_z_.draw(random), proposal.state);
    }
    return false;
}

Kernel::Proposal Kernel::propose(const ChainState& state, Random& random) const {
    double left = random.uniform();
    std::size_t chosen = 0;
    for (; chosen + 1 < move_count && left >= shares_[chosen]; ++chosen) left -= shares_[chosen];
    Proposal out;
    out.move = static_cast<Move>(chosen);
    out.threshold = std::log(random.uniform());
    out.possible = place(state, out, random);
    return out;
}

double Kernel::log_ratio(Move move, ChainState& state, ChainState& proposed, double temper) const {
    const auto known = [](std::optional<double>& value, const TMixture& mixture, const Vector& point) {
        if (!value) value = mixture.log_density(point);
        return *value;
    };
    double ratio = temper * (proposed.log_density - state.log_density);
    // A density of u becomes one of z by the factor du/dz, which is the normal density.
    if (move == difference_z || move == independent_z)
        ratio -= 0.5 * (proposed.z.squaredNorm() - state.z.squaredNorm());
    if (move == independent_u) {
        ratio += known(state.log_proposal_u, mixture_u_, state.u) -
                 known(proposed.log_proposal_u, mixture_u_, proposed.u);
    }
    if (move == independent_z) {
        ratio += known(state.log_proposal_z, mixture_z_, state.z) -
                 known(proposed.log_proposal_z, mixture_z_, proposed.z);
    }
    return ratio;
}

bool Kernel::accept(ChainState& state, Proposal& proposal, double temper, Tally& tally) const {
    tally.steps += 1;
    if (!proposal.possible) return false;
    tally.cost[proposal.move] += 1;
    if (!std::isfinite(proposal.state.log_density) ||
        !(proposal.threshold < log_ratio(proposal.move, state, proposal.state, temper)))
        return false;
    tally.accepted += 1;
    tally.jumped[proposal.move] +=
        root_z_.triangularView<Eigen::Lower>().solve(proposal.state.z - state.z).squaredNorm();
    state = std::move(proposal.state);
    return true;
}

std::vector<bool> Kernel::sweep(std::vector<ChainState>& states, double temper, Random& random,
                                Tally& tally) const {
    std::vector<Proposal> proposals;
    for (const ChainState& state : states) proposals.push_back(propose(state, random));
    std::vector<ChainState*> possible;
    for (Proposal& proposal : proposals)
        if (proposal.possible) possible.push_back(&proposal.state);
    target_.evaluate(possible);
    std::vector<bool> out;
    for (std::size_t i = 0; i < states.size(); ++i)
        out.push_back(accept(states[i], proposals[i], temper, tally));
    return out;
}

}  // namespace loam::optimizers
