// Loading by the velocity gradient, of a periodic cell or of a box of walls: stress servo and quasi-static
// strain rates.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "engine/simulation.hpp"

namespace loam::engine {

/// Strain rate (1/s) at which a packing of grains d (m) and density rho (kg/m³) under mean stress p (Pa) has
/// the inertial number I = rate · d · sqrt(rho / p) (GDR MiDi 2004).
double rate_for_inertial_number(double inertial_number, double mean_stress, double mean_diameter,
                                double grain_density);

/// The inertial number of that rate.
double inertial_number(double rate, double mean_stress, double mean_diameter, double grain_density);

struct ServoOptions {
    double inertial_number = 5e-3;   // limit of the strain rate of each axis
    double stress_tolerance = 0.01;  // relative, every axis
    double unbalanced_ratio = 0.01;  // at rest below this
    double relaxation_steps = 60;    // time constant of the servo, in steps, for the affine stiffness
    int measure_every = 5;           // steps
    bool learns_rate = true;         // see StressServo; a loose cloud that is being closed has none to learn
    std::uint64_t max_steps = 2'000'000;
    /// The normal stresses to be steered (Pa), e.g. the pressures on the walls of a box; without it
    /// Love-Weber's.
    std::function<Eigen::Vector3d(const Simulation&)> stress_of = {};
};

struct ServoSummary {
    bool converged = false;
    std::uint64_t steps = 0;
    double stress_error = 0;  // largest relative error of an axis at the end
    double unbalanced_ratio = 0;
};

/// Steers the velocity gradient so that the normal stresses approach a target; what has no target (an axis
/// whose target is NaN, shear) follows a prescribed velocity gradient, which is zero unless given. The strain
/// rate of an axis is what it misses over the affine stiffness and the relaxation time; because that
/// stiffness is an upper estimate, nearly nil while a packing yields, the rate is eased where the stress does
/// not follow. Where another axis is driven, or the packing yields under the stress that is held, an axis has
/// to move all the time, and a rate in proportion to what is missing would lag behind: the servo also learns
/// the rate that is needed (a proportional-integral controller).
class StressServo {
  public:
    /// `target` [3] (Pa) has at least one number. Throws std::invalid_argument.
    StressServo(const Eigen::Vector3d& target, const ServoOptions& options);

    /// What has no target moves like this from now on (1/s; negative for compression). The diagonal entries
    /// of controlled axes are ignored.
    void prescribe(const Eigen::Matrix3d& gradient);

    /// One stretch of options.measure_every steps; returns its measurement.
    const Measurement& advance(Simulation& simulation);
    /// Largest relative error of an axis that has a target.
    double stress_error(const Simulation& simulation) const;

  private:
    Eigen::Vector3d stress(const Simulation& simulation) const;
    double eased_rate(int axis, double missing, double relaxation);

    Eigen::Vector3d target_;
    double scale_ = 0;  // mean of the targets (Pa)
    ServoOptions options_;
    Eigen::Matrix3d prescribed_ = Eigen::Matrix3d::Zero();
    Eigen::Vector3d ease_ = Eigen::Vector3d::Ones(), missing_before_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d needed_ = Eigen::Vector3d::Zero();  // strain rate that holds the stress (1/s)
};

/// Brings the packing to these normal stresses (Pa; NaN: the axis keeps its length) and to rest. `each` is
/// called after every stretch with its measurement; a false answer ends it. Not converging within max_steps
/// is reported, not thrown.
ServoSummary hold_stress(Simulation& simulation, const Eigen::Vector3d& target, const ServoOptions& options,
                         const std::function<bool(const Measurement&)>& each = {});

/// The same for an isotropic stress (Pa). `cancelled` is polled; a true answer throws std::runtime_error.
ServoSummary consolidate(Simulation& simulation, double stress, const ServoOptions& options,
                         const std::function<bool()>& cancelled = {});

}  // namespace loam::engine
