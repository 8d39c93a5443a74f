#include "optimizers/tempering.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace loam::optimizers {

namespace {

constexpr int most_sweeps = 20;  // of moves at one temper

/// `size` uniform points of finite density, or as many as can be found.
std::vector<ChainState> uniform_particles(CubeTarget& target, int size,
                                          const std::function<bool()>& half_spent, Random& random) {
    std::vector<ChainState> particles;
    while (static_cast<int>(particles.size()) < size && !half_spent()) {
        ChainState state;
        Vector u(target.size());
        for (double& entry : u) entry = random.uniform();
        CubeTarget::place_u(u, state);
        target.evaluate({{&state}});
        if (std::isfinite(state.log_density)) particles.push_back(std::move(state));
    }
    if (static_cast<Eigen::Index>(particles.size()) < target.size() + 2) {
        throw std::runtime_error(
            "optimizers: no posterior, because the density is finite and not zero at only " +
            std::to_string(particles.size()) + " of " + std::to_string(target.evaluations()) +
            " points spread over the box");
    }
    return particles;
}

/// density^step of the particles, the greatest being 1.
Vector weights(const std::vector<ChainState>& particles, double step) {
    Vector logs(static_cast<Eigen::Index>(particles.size()));
    for (Eigen::Index i = 0; i < logs.size(); ++i)
        logs(i) = particles[static_cast<std::size_t>(i)].log_density;
    return (step * (logs.array() - logs.maxCoeff())).exp();
}

/// The step of the temper that leaves half of the particles effective (Kish 1965), at most `limit`.
double next_step(const std::vector<ChainState>& particles, double limit) {
    const auto enough = [&](double step) {
        const Vector w = weights(particles, step);
        return w.sum() * w.sum() >= 0.5 * static_cast<double>(w.size()) * w.squaredNorm();
    };
    if (enough(limit)) return limit;
    double low = 0, high = limit;
    for (int i = 0; i < 200 && high > 1.01 * low; ++i) {
        const double middle = low > 0 ? 0.5 * (low + high) : 0.1 * high;
        (enough(middle) ? low : high) = middle;
    }
    return high;
}

/// Systematic resampling: copies in proportion to the weights, to within one (Carpenter, Clifford & Fearnhead
/// 1999, IEE Proc. Radar 146, 2-7).
std::vector<ChainState> resampled(const std::vector<ChainState>& particles, const Vector& weight, int size,
                                  Random& random) {
    std::vector<ChainState> chosen;
    const double spacing = weight.sum() / size;
    double position = random.uniform() * spacing, sum = weight(0);
    for (Eigen::Index i = 0; static_cast<int>(chosen.size()) < size;) {
        if (position < sum || i + 1 == weight.size()) {
            chosen.push_back(particles[static_cast<std::size_t>(i)]);
            position += spacing;
        } else {
            sum += weight(++i);
        }
    }
    return chosen;
}

}  // namespace

WarmUp warm_up(CubeTarget& target, int size, const std::function<bool()>& half_spent, Random& random) {
    WarmUp state{uniform_particles(target, size, half_spent, random), {}};
    state.shares.fill(1.0 / move_count);
    // Copies have parted when their mean squared jump adds up to the squared distance of independent points,
    // 2 k.
    const double parted = 2.0 * static_cast<double>(target.size()) * size;
    for (double temper = 0; temper < 1;) {
        const double left = 1 - temper;
        const double step = half_spent() ? left : next_step(state.particles, left);
        temper = step < left ? temper + step : 1;
        state.particles = resampled(state.particles, weights(state.particles, step), size, random);
        for (ChainState& particle : state.particles)
            particle.log_proposal_u = particle.log_proposal_z = std::nullopt;
        const Kernel kernel(target, state.particles, 4, state.shares, random);
        Tally tally;
        for (int sweep = 0; sweep < most_sweeps && tally.total_jumped() < parted && !half_spent(); ++sweep) {
            kernel.sweep(state.particles, temper, random, tally);
        }
        state.shares = tally.shares();
    }
    return state;
}

}  // namespace loam::optimizers
