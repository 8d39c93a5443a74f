// The packing generators of packing.hpp and boxed_packing.hpp.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "engine/boxed_packing.hpp"
#include "engine/cloud.hpp"
#include "engine/loading.hpp"
#include "engine/packing.hpp"
#include "engine/require.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

using Eigen::Vector3d;

constexpr double high_friction = 1.2;         // rad: gives the loosest packings
constexpr double lowest_friction = 0.003;     // rad: below it nothing gets denser
constexpr double preparation_density = 2600;  // kg/m³; the result does not depend on it
constexpr double compaction_inertia = 8e-3;   // inertial number while the cloud is closed
constexpr double settling_inertia = 3e-3;     // inertial number of the servo afterwards
// Soft particles, over the stress, take fewer steps: up to this porosity above the target the way is theirs.
constexpr double soft_ratio = 2000, soft_margin = 6e-3;
constexpr double stretches_at_a_friction = 30;  // of the servo, of soft particles
constexpr double near_target = 0.01;  // in porosity: the part of the way that is gone again where it fails

LinearCohesive preparation_law(double stiffness_ratio, double stress, double friction) {
    LinearCohesive law;
    law.young_modulus = stiffness_ratio * stress;
    law.friction_angle = friction;
    law.normal_cohesion = law.shear_cohesion = 0;
    return law;
}

double softened(const PackingOptions& options) {
    return std::min(soft_ratio, options.stiffness_ratio);
}

/// Lowers the friction, a little at a time under constant stress, until the packing is dense enough; then
/// friction is raised again and the packing comes to rest. Loose packings collapse now and then: where that
/// has passed the target, the last part of the way is gone again in smaller steps, stopping earlier; the
/// nearest of all tries is kept.
class Densification {
  public:
    Densification(Simulation& simulation, const PackingOptions& options, const ServoOptions& servo,
                  const std::function<void()>& poll)
        : simulation_(simulation), options_(options), servo_(servo), poll_(poll) {}

    /// Whether the packing came to rest.
    bool run() {
        const Place start{simulation_, high_friction};
        far_ = start;
        std::optional<Try> best;
        // Coming to rest makes it denser by about a thousandth.
        double enough = options_.target_porosity + 0.6 * options_.tolerance, factor = 0.97;
        for (int attempt = 0; attempt < most_attempts; ++attempt) {
            if (attempt > 0) go_back_to(far_->simulation.porosity() > enough + near_target ? *far_ : start);
            lower_friction(enough, factor);
            const bool rested = come_to_rest();
            const double off = simulation_.porosity() - options_.target_porosity;
            if (!best || std::abs(off) < std::abs(best->off)) best = {{simulation_, friction_}, off, rested};
            const bool dense_from_the_start = friction_ == high_friction && off < 0;
            if (std::abs(off) <= options_.tolerance || friction_ <= lowest_friction || dense_from_the_start)
                break;
            enough -= off;
            factor = std::sqrt(factor);
        }
        go_back_to(best->place);
        return best->rested;
    }

    double friction() const { return friction_; }  // lowest that was used (rad)

  private:
    static constexpr int most_attempts = 5;
    struct Place {
        Simulation simulation;
        double friction;
    };
    struct Try {
        Place place;
        double off;  // porosity over the target
        bool rested;
    };

    void go_back_to(const Place& place) {
        simulation_ = place.simulation;
        friction_ = place.friction;
    }

    bool come_to_rest() {
        simulation_.set_law(preparation_law(options_.stiffness_ratio, options_.stress, high_friction));
        ServoOptions gentle = servo_;
        gentle.unbalanced_ratio = 0.005;
        return consolidate(simulation_, options_.stress, gentle, [this] { return poll_(), false; }).converged;
    }

    void lower_friction(double enough, double factor) {
        // The soft contacts' overlaps are released, and what opens closes again on the rest of the way.
        if (options_.stiffness_ratio > soft_ratio) lower_friction(enough + soft_margin, factor, soft_ratio);
        lower_friction(enough, factor, options_.stiffness_ratio);
    }

    void lower_friction(double enough, double factor, double stiffness_ratio) {
        // Stiffer particles take more steps to move as far.
        const double stretches =
            stretches_at_a_friction * std::sqrt(std::max(1.0, stiffness_ratio / soft_ratio));
        StressServo steer(Vector3d::Constant(options_.stress), servo_);
        const auto stay = [&](double until) {
            simulation_.set_law(preparation_law(stiffness_ratio, options_.stress, friction_));
            for (int k = 0; k < stretches && simulation_.porosity() > until; ++k) steer.advance(simulation_);
            poll_();
        };
        if (stiffness_ratio > soft_ratio) stay(0);  // how dense it is shows after the rebound
        while (simulation_.porosity() > enough && friction_ > lowest_friction) {
            if (simulation_.porosity() > enough + near_target) far_ = {simulation_, friction_};
            friction_ *= factor;
            stay(enough);
        }
    }

    Simulation& simulation_;
    const PackingOptions& options_;
    const ServoOptions& servo_;
    const std::function<void()>& poll_;
    double friction_ = high_friction;
    std::optional<Place> far_;  // the last place on the way that was far from the target
};

SimulationOptions preparation() {
    SimulationOptions how;
    how.grain_density = preparation_density;
    how.neighbour_skin = 0.2;  // particles move far here
    return how;
}

/// Makes a packing of the cloud in the simulation, by the velocity gradient; says all but the packing itself.
PackingResult compact(Simulation& simulation, const PackingOptions& options,
                      const std::function<bool()>& cancelled) {
    const auto started = std::chrono::steady_clock::now();
    const std::function<void()> poll = [&] {
        if (cancelled && cancelled()) throw std::runtime_error("cancelled");
    };
    // Close the cloud: isotropic compression until the stress is reached.
    const double rate = rate_for_inertial_number(compaction_inertia, options.stress,
                                                 simulation.mean_diameter(), preparation_density);
    simulation.set_velocity_gradient(-Eigen::Matrix3d::Identity() * rate);
    while (simulation.advance(20).mean_stress < options.stress && simulation.porosity() > 0.05) poll();

    ServoOptions servo;
    servo.inertial_number = settling_inertia;
    servo.unbalanced_ratio = 0.02;
    servo.max_steps = 200'000;
    servo.learns_rate = false;
    consolidate(simulation, options.stress, servo, cancelled);

    Densification way(simulation, options, servo, poll);
    const bool rested = way.run();
    PackingResult result;
    result.packing = simulation.packing();
    result.porosity = 1.0 - result.packing.solid_volume() / simulation.volume();
    result.reached = std::abs(result.porosity - options.target_porosity) <= options.tolerance;
    result.stress = simulation.measured().mean_stress;
    result.steps = simulation.steps();
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    result.stopped_by = !rested          ? "no rest within the steps allowed"
                        : result.reached ? "target porosity reached"
                        : way.friction() > lowest_friction
                            ? "looser than friction can hold: the loosest packing"
                            : "denser than a packing without friction: the densest packing";
    return result;
}

}  // namespace

void PackingOptions::validate() const {
    require(particles >= 100 && particles <= 2'000'000, "particles", particles, "within 100..2000000");
    require(mean_radius > 0, "mean_radius", mean_radius, "positive (m)");
    require(size_spread >= 0 && size_spread <= 0.9, "size_spread", size_spread, "within 0..0.9");
    require(target_porosity > 0.05 && target_porosity < 0.6, "target_porosity", target_porosity,
            "within 0.05..0.6");
    require(stress > 0, "stress", stress, "positive (Pa)");
    require(stiffness_ratio >= 100, "stiffness_ratio", stiffness_ratio, "at least 100");
    require(tolerance > 0, "tolerance", tolerance, "positive");
}

PackingResult make_packing(const PackingOptions& options, const std::function<bool()>& cancelled) {
    options.validate();
    Simulation simulation(make_cloud(options),
                          preparation_law(softened(options), options.stress, high_friction), preparation());
    return compact(simulation, options, cancelled);
}

void BoxedPackingOptions::validate() const {
    PackingOptions::validate();
    require(proportions.allFinite() && proportions.minCoeff() > 0, "proportions of the box",
            proportions.minCoeff(), "positive");
    require(margin >= 0.1 && margin <= 2, "margin", margin, "within 0.1..2");
}

BoxedPackingResult make_boxed_packing(const BoxedPackingOptions& options,
                                      const std::function<bool()>& cancelled) {
    options.validate();
    const BoxedCloud cloud = make_boxed_cloud(options, options.proportions, options.margin);
    Simulation simulation(cloud.packing, preparation_law(softened(options), options.stress, high_friction),
                          preparation());
    const BoxWalls walls = add_box(simulation, cloud.box);
    BoxedPackingResult result{compact(simulation, options, cancelled), present_box(simulation, walls)};
    return result;
}

}  // namespace loam::engine
