#include "engine/wall_servo.hpp"

#include <algorithm>

#include "engine/loading.hpp"
#include "engine/require.hpp"

namespace loam::engine {

void WallServoOptions::validate() const {
    require(inertial_number > 0, "inertial_number", inertial_number, "positive");
    require(contact_relaxation_steps >= 1, "contact_relaxation_steps", contact_relaxation_steps, ">= 1");
    require(packing_relaxation_steps >= 1, "packing_relaxation_steps", packing_relaxation_steps, ">= 1");
    require(mean_over > 0, "mean_over", mean_over, "positive");
}

WallServo::WallServo(std::size_t wall, double pressure, double area, const WallServoOptions& options)
    : wall_(wall), target_(pressure), area_(area), options_(options) {
    require(pressure > 0, "pressure of a wall", pressure, "positive (Pa)");
    require(area > 0, "area of a wall under pressure", area, "positive (m2)");
    options.validate();
}

void WallServo::set_target(double pressure) {
    require(pressure > 0, "pressure of a wall", pressure, "positive (Pa)");
    target_ = pressure;
}

double WallServo::pressure(const Simulation& simulation) const {
    return -simulation.walls().force(wall_).dot(simulation.walls().wall(wall_).normal()) / area_;
}

void WallServo::steer(Simulation& simulation) const {
    const Measurement& now = simulation.measured();
    const double depth = simulation.volume() / area_;
    // The affine stiffness is that of the bulk; a floor keeps a loose packing moving.
    const double of_packing = std::max(now.affine_stiffness, target_) * area_ / depth;
    const double resistance =
        std::max(options_.contact_relaxation_steps * simulation.walls().stiffness(wall_),
                 options_.packing_relaxation_steps * of_packing);
    WallDrive drive;
    drive.force = target_ * area_;
    drive.speed_per_force = 1 / (resistance * simulation.time_step());
    drive.mean_over = std::max(1.0, options_.mean_over * resistance / of_packing);
    drive.limit =
        depth * rate_for_inertial_number(options_.inertial_number, std::max(now.mean_stress, target_),
                                         simulation.mean_diameter(), simulation.grain_density());
    simulation.drive_wall(wall_, drive);
}

}  // namespace loam::engine
