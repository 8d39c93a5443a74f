#include "experiments/lab_tests/direct_shear.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "experiments/lab_tests/care.hpp"
#include "experiments/lab_tests/consolidation.hpp"
#include "experiments/lab_tests/shear_box.hpp"

namespace loam::experiments {
namespace {

using engine::Measurement;
using engine::Simulation;

constexpr int measure_every = 5;           // steps
constexpr double shear_zone = 10;          // diameters
constexpr double at_rest = 0.01;           // unbalanced-force ratio
constexpr double pressure_reached = 0.01;  // relative error
// Started at once, the box rings: the first shear stress was off by up to 15 % at an inertial number of 2e-3.
// So the speed grows with the displacement, from a tenth, until that over the length is so much.
constexpr double whole_speed_at = 0.005, first_speed = 0.1;
constexpr std::uint64_t most_loading_steps = 1'000'000;

/// The packing at rest under its isotropic stress, between six plain walls.
engine::Packing rested(const engine::Packing& packing, engine::Box& box, const engine::ContactLaw& law,
                       const engine::SimulationOptions& how, const DirectShearOptions& options,
                       DirectShearResult& result, const std::function<bool()>& cancelled) {
    Simulation simulation(packing, law, how);
    const engine::BoxWalls walls = engine::add_box(simulation, box);
    engine::ServoOptions servo = options.servo;
    servo.stress_of = [&](const Simulation& s) { return engine::box_pressures(s, walls); };
    const auto rest = consolidate_with(simulation, law, options.isotropic_stress, options.seating_stiffness,
                                       servo, cancelled);
    if (!rest.converged) result.reason = "the packing did not come to rest before it was loaded";
    box = engine::present_box(simulation, walls);
    result.steps = simulation.steps();
    return simulation.packing();
}

class Shearing {
  public:
    Shearing(Simulation& simulation, const ShearBox& box, double length, const DirectShearOptions& options,
             DirectShearResult& result, const std::function<bool()>& cancelled)
        : simulation_(simulation),
          box_(box),
          options_(options),
          result_(result),
          cancelled_(cancelled),
          servo_(box.platen(), options.normal_stress, box.plan(), slow(options)),
          length_(length) {}

    /// Presses the platen down to the normal stress; whether the packing came to rest.
    bool load() {
        const Measurement* now = &simulation_.advance(1);
        while (simulation_.steps() < most_loading_steps) {
            now = &stretch();
            if (now->unbalanced_ratio < at_rest && normal_error() < pressure_reached) break;
        }
        servo_ = engine::WallServo(box_.platen(), options_.normal_stress, box_.plan(), options_.platen);
        height_ = box_.height(simulation_);
        result_.height = height_;
        result_.loaded_porosity = simulation_.porosity();
        result_.loading_error = normal_error();
        return simulation_.steps() < most_loading_steps;
    }

    /// Shears to that displacement (over the length) and reads the test there.
    DirectShearReading to(double displacement) {
        DirectShearReading before = read(), now = before;
        while (now.displacement < displacement) {
            before = now;
            if (!options_.pressures.empty()) servo_.set_target(target_ = measured_pressure());
            const double strain_rate = rate();
            box_.move(simulation_, strain_rate * zone());
            look(stretch(), strain_rate);
            now = read();
        }
        const double way = now.displacement - before.displacement;
        const double share = way > 0 ? (displacement - before.displacement) / way : 0.0;
        DirectShearReading out = now;
        for (double DirectShearReading::*what :
             {&DirectShearReading::displacement, &DirectShearReading::shear_stress,
              &DirectShearReading::normal_stress, &DirectShearReading::wall_share,
              &DirectShearReading::settlement, &DirectShearReading::void_ratio,
              &DirectShearReading::coordination_number})
            out.*what = before.*what + share * (now.*what - before.*what);
        return out;
    }

    void finish() {
        if (stretches_ == 0) return;
        result_.mean_unbalanced_ratio = unbalanced_sum_ / stretches_;
        result_.mean_normal_error = error_sum_ / stretches_;
    }

  private:
    static engine::WallServoOptions slow(const DirectShearOptions& options) {
        engine::WallServoOptions out = options.platen;
        out.inertial_number = options.loading_inertial_number;
        return out;
    }

    const Measurement& stretch() {
        if (cancelled_ && cancelled_()) throw std::runtime_error("cancelled");
        servo_.steer(simulation_);
        const Measurement& now = simulation_.advance(measure_every);
        simulation_.set_reference_volume(box_.plan() * box_.height(simulation_));
        return now;
    }

    double normal_error() const { return std::abs(servo_.pressure(simulation_) / target_ - 1); }

    /// What the platen is to press with at the present displacement (Pa).
    double measured_pressure() const {
        const auto& all = options_.pressures;
        const double x = box_.displacement(simulation_) / length_;
        const auto after = std::ranges::lower_bound(all, x, {}, &PlatenPressure::displacement);
        if (after == all.begin()) return after->normal_stress;
        if (after == all.end()) return all.back().normal_stress;
        const auto before = after - 1;
        const double share = (x - before->displacement) / (after->displacement - before->displacement);
        return before->normal_stress + share * (after->normal_stress - before->normal_stress);
    }
    double zone() const { return std::min(height_, shear_zone * simulation_.mean_diameter()); }

    DirectShearReading read() const {
        const double pressure = servo_.pressure(simulation_), porosity = simulation_.porosity();
        DirectShearReading now;
        now.displacement = box_.displacement(simulation_) / length_;
        now.shear_stress = box_.shear_force(simulation_) / box_.plan();
        now.normal_stress = pressure;
        now.wall_share = box_.load_of_sides(simulation_) / (pressure * box_.plan());
        now.settlement = 1 - box_.height(simulation_) / height_;
        now.void_ratio = porosity / (1 - porosity);
        now.coordination_number = simulation_.measured().coordination_number;
        return now;
    }

    double inertial_rate(double inertial_number) const {
        return engine::rate_for_inertial_number(inertial_number, options_.normal_stress,
                                                simulation_.mean_diameter(), simulation_.grain_density());
    }

    double rate() const {
        const double start = first_speed + box_.displacement(simulation_) / length_ / whole_speed_at;
        return care_.factor() * std::min(1.0, start) *
               std::min(std::max(inertial_rate(options_.inertial_number),
                                 options_.strain_per_step / simulation_.time_step()),
                        inertial_rate(options_.highest_inertial_number));
    }

    void look(const Measurement& now, double strain_rate) {
        const double inertial = engine::inertial_number(
            strain_rate, options_.normal_stress, simulation_.mean_diameter(), simulation_.grain_density());
        result_.largest_inertial_number = std::max(result_.largest_inertial_number, inertial);
        result_.largest_overlap = std::max(result_.largest_overlap, now.max_overlap);
        result_.largest_normal_error = std::max(result_.largest_normal_error, normal_error());
        care_.look(normal_error());
        error_sum_ += normal_error();
        unbalanced_sum_ += now.unbalanced_ratio;
        stretches_ += 1;
    }

    Simulation& simulation_;
    const ShearBox& box_;
    const DirectShearOptions& options_;
    DirectShearResult& result_;
    const std::function<bool()>& cancelled_;
    engine::WallServo servo_;
    Care care_;
    double target_ = options_.normal_stress;  // Pa, of the platen
    double length_, height_ = 0, error_sum_ = 0, unbalanced_sum_ = 0, stretches_ = 0;
};

}  // namespace

void DirectShearOptions::validate() const {
    const auto check = [](bool right, const char* text) {
        if (!right) throw std::invalid_argument(text);
    };
    check(normal_stress > 0 && std::isfinite(normal_stress), "normal_stress: must be positive (Pa)");
    const auto place = [](const PlatenPressure& at) { return at.displacement; };
    const bool rise = std::ranges::adjacent_find(pressures, std::greater_equal{}, place) == pressures.end();
    check(rise, "pressures: displacements must rise");
    check(std::ranges::all_of(pressures, [](const PlatenPressure& at) { return at.normal_stress > 0; }),
          "pressures: must be positive (Pa)");
    check(!displacements.empty(), "displacements: at least one is needed");
    check(std::ranges::is_sorted(displacements), "displacements: must rise");
    check(displacements.empty() || (displacements.front() >= 0 && displacements.back() <= 0.5),
          "displacements: every one must be within 0..0.5 of the box's length");
    check(wall_friction_angle >= 0 && wall_friction_angle < 1.57,
          "wall_friction_angle: must be within 0..1.57 (rad)");
    check(gap >= 0 && gap < 1, "gap: must be within 0..1 (mean diameters)");
    check(inertial_number > 0 && inertial_number < 0.1, "inertial_number: must be within 0..0.1");
    check(loading_inertial_number > 0 && loading_inertial_number < 0.1,
          "loading_inertial_number: must be within 0..0.1");
    check(isotropic_stress > 0, "isotropic_stress: must be positive (Pa)");
}

DirectShearResult run_direct_shear(const engine::Packing& packing, const engine::Box& box,
                                   const engine::ContactLaw& law, const engine::SimulationOptions& how,
                                   const DirectShearOptions& options, const std::function<bool()>& cancelled,
                                   const SimulationInspector& inspect) {
    options.validate();
    DirectShearResult result;
    engine::Box rest = box;
    const engine::ContactLaw seating = law.of_seating();
    const engine::Packing start = rested(packing, rest, seating, how, options, result, cancelled);
    if (!result.reason.empty()) return result;

    const double length = rest.sides().x(), travel = 1.02 * options.displacements.back() * length;
    const RoomyPacking roomy = with_room(start, rest, travel);
    Simulation simulation(roomy.packing, seating, how);
    const ShearBox shear_box(simulation, roomy.box, options.gap * simulation.mean_diameter(), travel,
                             options.wall_friction_angle);
    simulation.set_reference_volume(roomy.box.volume());
    Shearing shearing(simulation, shear_box, length, options, result, cancelled);
    if (!shearing.load()) {
        result.reason = "the packing did not come to rest under the normal stress";
        return result;
    }
    begin_test(simulation, law);
    simulation.restart_energy_balance();
    for (const double displacement : options.displacements)
        result.readings.push_back(shearing.to(displacement));
    shearing.finish();
    result.complete = true;
    result.energy_error = simulation.energy().error();
    result.steps += simulation.steps();
    if (inspect) inspect(simulation);
    return result;
}

}  // namespace loam::experiments
