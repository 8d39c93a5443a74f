#include "experiments/lab_tests/triaxial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "experiments/lab_tests/care.hpp"
#include "experiments/lab_tests/consolidation.hpp"

namespace loam::experiments {
namespace {

using engine::Measurement;
using engine::Simulation;

constexpr double uncontrolled = std::numeric_limits<double>::quiet_NaN();

engine::ServoOptions steered(engine::ServoOptions servo, const TriaxialOptions& options) {
    if (options.stress_of) servo.stress_of = options.stress_of;
    return servo;
}

/// Axial compression in stretches of a few steps, with the rate chosen anew for each.
class Compression {
  public:
    Compression(Simulation& simulation, const TriaxialOptions& options, TriaxialResult& result,
                const std::function<bool()>& cancelled)
        : simulation_(simulation),
          options_(options),
          result_(result),
          cancelled_(cancelled),
          servo_({options.cell_pressure, options.cell_pressure, uncontrolled},
                 steered(options.lateral, options)),
          height_(simulation.cell()(2, 2)),
          volume_(simulation.volume()) {}

    /// Compresses to that axial strain and reads the test there.
    TriaxialReading to(double strain) {
        TriaxialReading before = read(), now = before;
        while (now.axial_strain < strain) {
            before = now;
            stretch();
            now = read();
        }
        const double way = now.axial_strain - before.axial_strain;
        const double share = way > 0 ? (strain - before.axial_strain) / way : 0.0;
        const auto between = [&](double TriaxialReading::*what) {
            return before.*what + share * (now.*what - before.*what);
        };
        return {way > 0 ? strain : now.axial_strain, between(&TriaxialReading::deviatoric_stress),
                between(&TriaxialReading::volumetric_strain), between(&TriaxialReading::void_ratio),
                between(&TriaxialReading::coordination_number)};
    }

    void finish() {
        if (stretches_ == 0) return;
        result_.mean_unbalanced_ratio = unbalanced_sum_ / stretches_;
        result_.mean_lateral_error = error_sum_ / stretches_;
    }

  private:
    /// The cell follows the velocity gradient as walls do, so that its sides tell the strains of a box too.
    TriaxialReading read() const {
        const Eigen::Vector3d now = stress();
        const double volume = simulation_.volume(), solid = simulation_.solid_volume();
        return {1 - simulation_.cell()(2, 2) / height_, now[2] - 0.5 * (now[0] + now[1]),
                1 - volume / volume_, (volume - solid) / solid, simulation_.measured().coordination_number};
    }

    Eigen::Vector3d stress() const {
        return options_.stress_of ? options_.stress_of(simulation_)
                                  : Eigen::Vector3d(simulation_.measured().stress.diagonal());
    }

    double inertial_rate(double inertial_number) const {
        const double stress = std::max(simulation_.measured().mean_stress, options_.cell_pressure);
        return engine::rate_for_inertial_number(inertial_number, stress, simulation_.mean_diameter(),
                                                simulation_.grain_density());
    }

    double rate() const {
        if (options_.strain_rate > 0) return options_.strain_rate;
        const double step = simulation_.time_step();
        const double wanted =
            std::min(std::max(inertial_rate(options_.inertial_number), options_.strain_per_step / step),
                     inertial_rate(options_.highest_inertial_number));
        // Stiff specimens are limited by how fast stress may change instead. The affine stiffness is an upper
        // estimate of the true one, which is nearly nil while a specimen yields: `ease_` follows what the
        // stress really does.
        const double stiffness = std::max(simulation_.measured().affine_stiffness, options_.cell_pressure);
        const double gentle = ease_ * options_.stress_change * options_.cell_pressure / (stiffness * step);
        return care_.factor() * std::min(wanted, std::max(gentle, options_.least_strain_per_step / step));
    }

    void stretch() {
        if (cancelled_ && cancelled_()) throw std::runtime_error("cancelled");
        Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
        const double strain_rate = rate(), stress_before = stress()[2];
        gradient(2, 2) = -strain_rate;
        servo_.prescribe(gradient);
        const Measurement& now = servo_.advance(simulation_);
        follow(std::abs(stress()[2] - stress_before) / options_.cell_pressure);
        look(now, strain_rate);
    }

    void follow(double change) {
        const double allowed = options_.stress_change * options_.lateral.measure_every;
        if (change > allowed) ease_ = std::max(1.0, 0.5 * ease_);
        if (change < 0.5 * allowed) ease_ = std::min(100.0, 1.1 * ease_);
    }

    void look(const Measurement& now, double strain_rate) {
        const double inertial = engine::inertial_number(
            strain_rate, now.mean_stress, simulation_.mean_diameter(), simulation_.grain_density());
        result_.largest_inertial_number = std::max(result_.largest_inertial_number, inertial);
        result_.largest_overlap = std::max(result_.largest_overlap, now.max_overlap);
        const Eigen::Array2d error = (stress().head<2>().array() / options_.cell_pressure - 1).abs();
        result_.largest_lateral_error = std::max(result_.largest_lateral_error, error.maxCoeff());
        care_.look(error.mean());
        error_sum_ += error.mean();
        unbalanced_sum_ += now.unbalanced_ratio;
        stretches_ += 1;
    }

    Simulation& simulation_;
    const TriaxialOptions& options_;
    TriaxialResult& result_;
    const std::function<bool()>& cancelled_;
    engine::StressServo servo_;
    Care care_;
    double height_, volume_, ease_ = 1, error_sum_ = 0, unbalanced_sum_ = 0, stretches_ = 0;
};

/// Isotropic consolidation; whether the packing came to rest.
bool consolidate_specimen(Simulation& simulation, const engine::ContactLaw& law,
                          const TriaxialOptions& options, TriaxialResult& result,
                          const std::function<bool()>& cancelled) {
    const auto rest = consolidate_with(simulation, law.of_seating(), options.cell_pressure,
                                       options.seating_stiffness, steered(options.servo, options), cancelled);
    begin_test(simulation, law);
    result.consolidation_error = rest.stress_error;
    result.consolidation_steps = simulation.steps();
    result.consolidated_porosity = simulation.porosity();
    return rest.converged;
}

}  // namespace

void TriaxialOptions::validate() const {
    if (!(cell_pressure > 0) || !std::isfinite(cell_pressure))
        throw std::invalid_argument("cell_pressure: must be positive (Pa)");
    if (strains.empty()) throw std::invalid_argument("strains: at least one axial strain is needed");
    if (!std::ranges::is_sorted(strains)) throw std::invalid_argument("strains: must rise");
    if (!(strains.front() >= 0 && strains.back() <= 0.6))
        throw std::invalid_argument("strains: every axial strain must be within 0..0.6");
    if (!(inertial_number > 0 && inertial_number < 0.1))
        throw std::invalid_argument("inertial_number: must be within 0..0.1");
    if (!(stress_change > 0 && stress_change < 0.1))
        throw std::invalid_argument("stress_change: must be within 0..0.1");
    if (!(strain_rate >= 0) || !std::isfinite(strain_rate))
        throw std::invalid_argument("strain_rate: must not be negative (1/s)");
}

TriaxialResult run_triaxial(Simulation& simulation, const engine::ContactLaw& law,
                            const TriaxialOptions& options, const std::function<bool()>& cancelled) {
    options.validate();
    TriaxialResult result;
    if (!consolidate_specimen(simulation, law, options, result, cancelled)) {
        result.steps = simulation.steps();
        result.reason = "the packing did not come to rest at the cell pressure";
        return result;
    }
    simulation.restart_energy_balance();
    Compression compression(simulation, options, result, cancelled);
    for (const double strain : options.strains) result.readings.push_back(compression.to(strain));
    compression.finish();
    result.complete = true;
    result.energy_error = simulation.energy().error();
    result.steps = simulation.steps();
    return result;
}

}  // namespace loam::experiments
