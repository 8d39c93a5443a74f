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

StressServo::StressServo(const Eigen::Vector3d& target, const ServoOptions& options)
    : target_(target), options_(options) {
    int axes = 0;
    for (const double t : target) {
        if (std::isnan(t)) continue;
        scale_ += t;
        ++axes;
    }
    if (axes == 0) throw std::invalid_argument("stress servo: at least one axis needs a target stress (Pa)");
    scale_ /= axes;
}

Eigen::Vector3d StressServo::stress(const Simulation& simulation) const {
    if (options_.stress_of) return options_.stress_of(simulation);
    return simulation.measured().stress.diagonal();
}

const Measurement& StressServo::advance(Simulation& simulation) {
    const Measurement& now = simulation.measured();
    const double limit = rate_for_inertial_number(options_.inertial_number, std::max(now.mean_stress, scale_),
                                                  simulation.mean_diameter(), simulation.grain_density());
    const double stiffness = std::max(now.affine_stiffness, scale_);  // a floor keeps a loose cloud moving
    const Eigen::Vector3d present = stress(simulation);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) {
        gradient(k, k) = 0.0 - rates_[k];
        if (std::isnan(target_[k])) continue;
        const double missing = target_[k] - present[k], before = missing_before_[k];
        if (missing * before <= 0)
            ease_[k] = std::max(1.0, 0.25 * ease_[k]);  // passed the target
        else if (std::abs(missing) > 0.97 * std::abs(before))
            ease_[k] = std::min(100.0, 1.05 * ease_[k]);
        else if (std::abs(missing) < 0.8 * std::abs(before))
            ease_[k] = std::max(1.0, 0.8 * ease_[k]);
        missing_before_[k] = missing;
        const double wanted =
            ease_[k] * missing / (stiffness * options_.relaxation_steps * simulation.time_step());
        const double rate = std::clamp(wanted + mean_rate_[k], -limit, limit);
        if (options_.mean_over > 0)
            mean_rate_[k] +=
                std::min(1.0, options_.measure_every / options_.mean_over) * (rate - mean_rate_[k]);
        gradient(k, k) = -rate;
    }
    simulation.set_velocity_gradient(gradient);
    return simulation.advance(options_.measure_every);
}

double StressServo::stress_error(const Simulation& simulation) const {
    const Eigen::Vector3d present = stress(simulation);
    double largest = 0;
    for (int k = 0; k < 3; ++k)
        if (!std::isnan(target_[k])) largest = std::max(largest, std::abs(present[k] - target_[k]));
    return largest / scale_;
}

ServoSummary hold_stress(Simulation& simulation, const Eigen::Vector3d& target, const ServoOptions& options,
                         const std::function<bool(const Measurement&)>& each) {
    const std::uint64_t start = simulation.steps();
    ServoSummary summary;
    StressServo servo(target, options);
    simulation.set_velocity_gradient(Eigen::Matrix3d::Zero());
    simulation.advance(1);
    for (int good = 0; simulation.steps() - start < options.max_steps;) {
        const Measurement& now = servo.advance(simulation);
        if (each && !each(now)) break;
        summary.stress_error = servo.stress_error(simulation);
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

ServoSummary consolidate(Simulation& simulation, double stress, const ServoOptions& options,
                         const std::function<bool()>& cancelled) {
    return hold_stress(simulation, Eigen::Vector3d::Constant(stress), options, [&](const Measurement&) {
        if (cancelled && cancelled()) throw std::runtime_error("cancelled");
        return true;
    });
}

}  // namespace loam::engine
