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

void StressServo::prescribe(const Eigen::Matrix3d& gradient) {
    prescribed_ = gradient;
    for (int k = 0; k < 3; ++k)
        if (!std::isnan(target_[k])) prescribed_(k, k) = 0;
}

/// The strain rate (1/s) that makes up for a missing stress (Pa) within the relaxation time, of which
/// `relaxation` (Pa s) is the product with the stiffness, times the ease, which follows how well the stress
/// obeys.
double StressServo::eased_rate(int axis, double missing, double relaxation) {
    double& ease = ease_[axis];
    const double before = missing_before_[axis];
    if (missing * before <= 0)
        ease = std::max(1.0, 0.25 * ease);  // passed the target
    else if (std::abs(missing) > 0.97 * std::abs(before))
        ease = std::min(100.0, 1.05 * ease);
    else if (std::abs(missing) < 0.8 * std::abs(before))
        ease = std::max(1.0, 0.8 * ease);
    missing_before_[axis] = missing;
    return ease * missing / relaxation;
}

const Measurement& StressServo::advance(Simulation& simulation) {
    const Measurement& now = simulation.measured();
    const double limit = rate_for_inertial_number(options_.inertial_number, std::max(now.mean_stress, scale_),
                                                  simulation.mean_diameter(), simulation.grain_density());
    const double stiffness = std::max(now.affine_stiffness, scale_);  // a floor keeps a loose cloud moving
    const Eigen::Vector3d present = stress(simulation);
    const double relaxation = stiffness * options_.relaxation_steps * simulation.time_step();
    Eigen::Matrix3d gradient = prescribed_;
    for (int k = 0; k < 3; ++k) {
        if (std::isnan(target_[k])) continue;
        const double correction = eased_rate(k, target_[k] - present[k], relaxation);
        const double rate = std::clamp(needed_[k] + correction, -limit, limit);
        // Four relaxation times: critical damping of a stress that follows the strain at the affine
        // stiffness.
        if (options_.learns_rate)
            needed_[k] += (rate - needed_[k]) * options_.measure_every / (4 * options_.relaxation_steps);
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
