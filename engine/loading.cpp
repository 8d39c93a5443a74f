#include "engine/loading.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace loam::engine {

double rate_for_inertial_number(double inertial_number, double mean_stress, double mean_diameter,
                                double grain_density) {
    return inertial_number / mean_diameter * std::sqrt(std::max(mean_stress, 0.0) / grain_density);
}

double inertial_number(double rate, double mean_stress, double mean_diameter, double grain_density) {
    return std::abs(rate) * mean_diameter * std::sqrt(grain_density / std::max(mean_stress, 1e-300));
}

void servo_rates(Simulation& simulation, const Eigen::Vector3d& target, const ServoOptions& options) {
    const Measurement& now = simulation.measured();
    const double scale = target.mean();
    const double limit = rate_for_inertial_number(options.inertial_number, std::max(now.mean_stress, scale),
                                                  simulation.mean_diameter(), simulation.grain_density());
    // The affine stiffness is an upper estimate, so that the approach is slow rather than oscillating; a
    // floor keeps a packing without contacts moving.
    const double stiffness = std::max(now.affine_stiffness, scale);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) {
        const double missing = target[k] - now.stress(k, k);
        const double rate = missing / (stiffness * options.relaxation_steps * simulation.time_step());
        gradient(k, k) = -std::clamp(rate, -limit, limit);
    }
    simulation.set_velocity_gradient(gradient);
}

ServoSummary consolidate(Simulation& simulation, double stress, const ServoOptions& options,
                         const std::function<bool()>& cancelled) {
    const Eigen::Vector3d target = Eigen::Vector3d::Constant(stress);
    const std::uint64_t start = simulation.steps();
    ServoSummary summary;
    simulation.advance(1);
    for (int good = 0; simulation.steps() - start < options.max_steps;) {
        servo_rates(simulation, target, options);
        const Measurement& now = simulation.advance(options.measure_every);
        if (cancelled && cancelled()) throw std::runtime_error("cancelled");
        summary.stress_error = (now.stress.diagonal() - target).cwiseAbs().maxCoeff() / stress;
        summary.unbalanced_ratio = now.unbalanced_ratio;
        const bool at_rest = summary.stress_error < options.stress_tolerance &&
                             summary.unbalanced_ratio < options.unbalanced_ratio;
        good = at_rest ? good + 1 : 0;
        if (good == 20) {  // and stays so
            summary.converged = true;
            break;
        }
    }
    simulation.set_velocity_gradient(Eigen::Matrix3d::Zero());
    summary.steps = simulation.steps() - start;
    return summary;
}

}  // namespace loam::engine
