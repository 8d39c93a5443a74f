#include "optimizers/posterior_kernel.hpp"

#include <cmath>
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

bool CubeTarget::evaluate_u(const Vector& u, ChainState& state) {
    if (!inside_cube(u)) return false;
    state.u = u;
    state.z = u.unaryExpr([](double value) { return normal_quantile(value); });
    return evaluate(state);
}

bool CubeTarget::evaluate_z(const Vector& z, ChainState& state) {
    state.z = z;
    state.u = z.unaryExpr([](double value) { return normal_probability(value); });
    return inside_cube(state.u) && evaluate(state);
}

bool CubeTarget::evaluate(ChainState& state) {
    state.x = box_.to_x(state.u);
    ++evaluations_;
    state.log_density = log_density_(state.x, nullptr);
    return std::isfinite(state.log_density);
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

bool Kernel::propose(Move move, const ChainState& state, ChainState& proposed, Random& random) const {
    // The length that is best for a normal density (ter Braak 2006), spread to suit others.
    const double length =
        2.38 / std::sqrt(2.0 * static_cast<double>(target_.size())) * (0.5 + random.uniform());
    switch (move) {
        case difference_u:
            return target_.evaluate_u(state.u + length * difference(u_, random), proposed);
        case difference_z:
            return target_.evaluate_z(state.z + length * difference(z_, random), proposed);
        case jump_u:
            return target_.evaluate_u(state.u + difference(u_, random), proposed);
        case independent_u:
            return target_.evaluate_u(mixture_u_.draw(random), proposed);
        case independent_z:
            return target_.evaluate_z(mixture_z_.draw(random), proposed);
    }
    return false;
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

bool Kernel::step(ChainState& state, double temper, Random& random, Tally& tally) const {
    double left = random.uniform();
    std::size_t chosen = 0;
    for (; chosen + 1 < move_count && left >= shares_[chosen]; ++chosen) left -= shares_[chosen];
    const double threshold = std::log(random.uniform());
    tally.steps += 1;
    ChainState proposed;
    const int before = target_.evaluations();
    const bool possible = propose(static_cast<Move>(chosen), state, proposed, random);
    tally.cost[chosen] += target_.evaluations() - before;
    if (!possible || !(threshold < log_ratio(static_cast<Move>(chosen), state, proposed, temper)))
        return false;
    tally.accepted += 1;
    tally.jumped[chosen] += root_z_.triangularView<Eigen::Lower>().solve(proposed.z - state.z).squaredNorm();
    state = std::move(proposed);
    return true;
}

}  // namespace loam::optimizers
