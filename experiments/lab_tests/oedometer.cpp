#include "experiments/lab_tests/oedometer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "experiments/lab_tests/consolidation.hpp"

namespace loam::experiments {
namespace {

using engine::Measurement;
using engine::Simulation;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Axial loading in stretches of a few steps, with the rate chosen anew for each.
class Loading {
  public:
    Loading(Simulation& simulation, const OedometerOptions& options, OedometerResult& result,
            const std::function<bool()>& cancelled)
        : simulation_(simulation), options_(options), result_(result), cancelled_(cancelled) {}

    void mark_seated() {
        seated_height_ = simulation_.cell()(2, 2);
        result_.initial_height = seated_height_;
        result_.seated_porosity = simulation_.porosity();
    }

    double strain() const { return 1.0 - simulation_.cell()(2, 2) / seated_height_; }

    /// Loads (or unloads) until the axial stress has passed `target`, and holds it there; at a given strain
    /// rate nothing is held, and the strain is that at the crossing. NaN, with the reason in the result,
    /// where it is not reached.
    double to(double target) {
        double before_stress = axial(), before_strain = strain();
        const double direction = target >= before_stress ? 1.0 : -1.0;
        while ((target - axial()) * direction > 0) {
            before_stress = axial();
            before_strain = strain();
            stretch(direction, target);
            if (strain() > options_.largest_strain) return too_far(target);
        }
        if (options_.strain_rate <= 0) return hold(target);
        const double now = axial();
        if (now == before_stress) return strain();
        // The crossing lies between two measurements: where on the way is linear in the stress.
        return before_strain + (strain() - before_strain) * (target - before_stress) / (now - before_stress);
    }

    double mean_unbalanced() const { return stretches_ > 0 ? unbalanced_sum_ / stretches_ : 0; }

  private:
    double axial() const { return simulation_.measured().stress(2, 2); }

    /// Holds the axial stress until the packing is at rest; returns the strain there, or NaN.
    double hold(double target) {
        const auto held = engine::hold_stress(simulation_, {none, none, target}, options_.hold,
                                              [&](const Measurement& now) {
                                                  look(now, simulation_.velocity_gradient()(2, 2));
                                                  return strain() <= options_.largest_strain;
                                              });
        ease_ = 1;
        if (held.converged) return strain();
        return strain() > options_.largest_strain ? too_far(target)
                                                  : failed(fmt::format("no rest at {} kPa", target / 1000));
    }

    double too_far(double target) {
        return failed(
            fmt::format("axial strain passed {} before {} kPa", options_.largest_strain, target / 1000));
    }

    double failed(const std::string& reason) {
        result_.complete = false;
        result_.reason = reason;
        return none;
    }

    double rate(double target) const {
        if (options_.strain_rate > 0) return options_.strain_rate;
        const Measurement& now = simulation_.measured();
        const double stress = std::max(axial(), std::min(target, options_.isotropic_stress));
        const double inertial = engine::rate_for_inertial_number(
            options_.inertial_number, stress, simulation_.mean_diameter(), simulation_.grain_density());
        const double highest =
            engine::rate_for_inertial_number(options_.highest_inertial_number, stress,
                                             simulation_.mean_diameter(), simulation_.grain_density());
        const double wanted =
            std::min(std::max(inertial, options_.strain_per_step / simulation_.time_step()), highest);
        // Stiff packings are limited by how fast stress may change instead. The affine stiffness is an upper
        // estimate of the true one, which is nearly nil while a packing yields: `ease_` follows what the
        // stress really does.
        const double stiffness = std::max(now.affine_stiffness, stress);
        const double gentle = ease_ * options_.stress_change * stress / (stiffness * simulation_.time_step());
        return std::min(wanted, std::max(gentle, options_.least_strain_per_step / simulation_.time_step()));
    }

    void follow(double stress_before) {
        const double change = std::abs(axial() - stress_before) / std::max(axial(), stress_before);
        const double allowed = options_.stress_change * options_.measure_every;
        if (change > allowed) ease_ = std::max(1.0, 0.5 * ease_);
        if (change < 0.5 * allowed) ease_ = std::min(20.0, 1.1 * ease_);
    }

    void stretch(double direction, double target) {
        Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
        const double strain_rate = rate(target);
        gradient(2, 2) = -direction * strain_rate;
        simulation_.set_velocity_gradient(gradient);
        const double stress_before = axial();
        const Measurement& now = simulation_.advance(options_.measure_every);
        follow(stress_before);
        look(now, strain_rate);
    }

    void look(const Measurement& now, double strain_rate) {
        if (cancelled_ && cancelled_()) throw std::runtime_error("cancelled");
        result_.largest_inertial_number = std::max(
            result_.largest_inertial_number,
            engine::inertial_number(strain_rate, std::max(now.mean_stress, 0.1 * options_.isotropic_stress),
                                    simulation_.mean_diameter(), simulation_.grain_density()));
        result_.largest_overlap = std::max(result_.largest_overlap, now.max_overlap);
        unbalanced_sum_ += now.unbalanced_ratio;
        stretches_ += 1;
        if (!options_.record_path) return;
        result_.path_strain.push_back(strain());
        result_.path_axial.push_back(axial());
        result_.path_lateral.push_back(0.5 * (now.stress(0, 0) + now.stress(1, 1)));
    }

    Simulation& simulation_;
    const OedometerOptions& options_;
    OedometerResult& result_;
    const std::function<bool()>& cancelled_;
    double ease_ = 1, seated_height_ = 1, unbalanced_sum_ = 0, stretches_ = 0;
};

}  // namespace

void OedometerOptions::validate() const {
    if (!(isotropic_stress > 0)) throw std::invalid_argument("isotropic_stress: must be positive (Pa)");
    if (!(seating_stress > 0)) throw std::invalid_argument("seating_stress: must be positive (Pa)");
    if (stages.empty()) throw std::invalid_argument("stages: at least one axial stress is needed");
    for (const double s : stages)
        if (!(s > 0) || !std::isfinite(s))
            throw std::invalid_argument("stages: every stress must be positive (Pa)");
    if (!(inertial_number > 0 && inertial_number < 0.1))
        throw std::invalid_argument("inertial_number: must be within 0..0.1");
    if (!(stress_change > 0 && stress_change < 0.1))
        throw std::invalid_argument("stress_change: must be within 0..0.1");
    if (!(largest_strain > 0 && largest_strain < 0.9))
        throw std::invalid_argument("largest_strain: must be within 0..0.9");
}

OedometerResult run_oedometer(Simulation& simulation, const engine::ContactLaw& law,
                              const OedometerOptions& options, const std::function<bool()>& cancelled) {
    options.validate();
    OedometerResult result;
    const auto stages = static_cast<Eigen::Index>(options.stages.size());
    result.strain = Eigen::VectorXd::Constant(stages, none);
    const auto seated = consolidate_with(simulation, law.of_seating(), options.isotropic_stress,
                                         options.seating_stiffness, options.servo, cancelled);
    result.seating_error = seated.stress_error;
    if (!seated.converged) {
        result.reason = "the packing did not come to rest at the seating stress";
        return result;
    }
    result.seating_steps = simulation.steps();
    simulation.restart_energy_balance();
    Loading loading(simulation, options, result, cancelled);
    loading.mark_seated();
    result.complete = true;
    if (options.seating_stress > options.isotropic_stress * 1.0001) {
        loading.to(options.seating_stress);
        loading.mark_seated();
    }
    begin_test(simulation, law);
    for (Eigen::Index k = 0; k < stages && result.complete; ++k) {
        // At the seating stress itself strain is zero by definition.
        const bool at_seat = k == 0 && options.stages[0] <= options.seating_stress * 1.0001;
        result.strain[k] = at_seat ? 0.0 : loading.to(options.stages[static_cast<std::size_t>(k)]);
    }
    result.mean_unbalanced_ratio = loading.mean_unbalanced();
    result.energy_error = simulation.energy().error();
    result.steps = simulation.steps();
    return result;
}

}  // namespace loam::experiments
