// A wall under constant pressure: a platen.
#pragma once

#include <cstddef>

#include "engine/simulation.hpp"

namespace loam::engine {

struct WallServoOptions {
    double inertial_number = 5e-3;  // limit of the wall's speed over the depth of the packing behind it
    // Time constants in steps, for the stiffness of the wall's contacts, which it meets at once, and for that
    // of the packing, which it meets later: the slower one counts.
    double contact_relaxation_steps = 2;
    double packing_relaxation_steps = 60;
    double mean_over = 1;  // over what the wall's mean speed is taken, over the time constant of the packing

    void validate() const;  // throws std::invalid_argument
};

/// Drives a wall along its normal, which points into the packing, so that its contacts press on it with
/// pressure·area. The speed is what the force misses over a stiffness and a relaxation time, and the mean
/// speed: so nothing is left missing where the packing yields steadily.
class WallServo {
  public:
    /// `pressure` (Pa) and `area` (m²) positive. Throws std::invalid_argument.
    WallServo(std::size_t wall, double pressure, double area, const WallServoOptions& options = {});

    /// Fits the wall's drive to the stiffness in the last step, which must have been measured; to be called
    /// after every few steps. What the velocity has along the wall is left alone.
    void steer(Simulation& simulation) const;
    void set_target(double pressure);                     // Pa; as of the constructor
    double pressure(const Simulation& simulation) const;  // on the wall in the last step (Pa)

  private:
    std::size_t wall_;
    double target_, area_;
    WallServoOptions options_;
};

}  // namespace loam::engine
