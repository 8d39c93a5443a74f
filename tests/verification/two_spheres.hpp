// Two spheres in a large periodic cell, for the tests against closed forms. Forces are read from the
// Love-Weber stress and positions from the packing, so that a test sees what any user of the engine sees.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/simulation.hpp"

namespace loam::engine {

inline double sphere_mass(double radius, double density) {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density;
}

/// m_1 m_2 / (m_1 + m_2).
inline double effective_mass(double radius_0, double radius_1, double density) {
    const double a = sphere_mass(radius_0, density), b = sphere_mass(radius_1, density);
    return a * b / (a + b);
}

/// Two particles in series, each of stiffness 2 E R (De Pue et al. 2019, eqs 4 and 6).
inline double series_stiffness(double young_modulus, double radius_0, double radius_1) {
    return 1.0 / (1.0 / (2 * young_modulus * radius_0) + 1.0 / (2 * young_modulus * radius_1));
}

struct PairOptions {
    double radius_0 = 0.05, radius_1 = 0.05;                    // m
    double gap = 0;                                             // m, negative for an overlap
    Eigen::Vector3d direction = Eigen::Vector3d(2, -1, 2) / 3;  // unit vector from the first to the second
    double safety = 0.01;                                       // of the time step
    double damping = 0;
    bool free_rotation = false;
    double largest_overlap = 0;  // over the sum of the radii, for a constant time step of Hertzian contacts
};

/// Linear springs without friction or cohesion.
inline LinearCohesive elastic_law(double young_modulus) {
    LinearCohesive law;
    law.young_modulus = young_modulus;
    law.normal_cohesion = law.shear_cohesion = law.friction_angle = 0;
    return law;
}

class TwoSpheres {
  public:
    TwoSpheres(const ContactLaw& law, const PairOptions& o) : simulation(pack(o), law, how(o)), options_(o) {
        mass_[0] = sphere_mass(o.radius_0, simulation.grain_density());
        mass_[1] = sphere_mass(o.radius_1, simulation.grain_density());
    }

    /// From the first sphere to the nearest copy of the second (m).
    Eigen::Vector3d branch() const {
        const Packing now = simulation.packing();
        Eigen::Vector3d f = now.cell.inverse() * (now.centres.col(1) - now.centres.col(0));
        for (int k = 0; k < 3; ++k) f[k] -= std::round(f[k]);
        return now.cell * f;
    }
    double radius_sum() const { return options_.radius_0 + options_.radius_1; }
    double gap() const { return branch().norm() - radius_sum(); }

    /// Velocity of the second relative to the first (m/s); the total momentum is zero.
    void set_relative_velocity(const Eigen::Vector3d& v) {
        Eigen::Matrix3Xd both(3, 2);
        both.col(0) = -v * mass_[1] / (mass_[0] + mass_[1]);
        both.col(1) = v * mass_[0] / (mass_[0] + mass_[1]);
        simulation.set_velocities(both);
    }
    Eigen::Vector3d relative_velocity() const {
        const Eigen::Matrix3Xd v = simulation.velocities();
        return v.col(1) - v.col(0);
    }
    /// Kinetic energy of the centres (J).
    double energy_of_translation() const {
        const Eigen::Matrix3Xd v = simulation.velocities();
        return 0.5 * (mass_[0] * v.col(0).squaredNorm() + mass_[1] * v.col(1).squaredNorm());
    }

    /// One step; returns the force on the first sphere at its beginning (N): from V stress = -f (x) branch.
    Eigen::Vector3d step() {
        const Eigen::Vector3d before = branch();
        simulation.advance(1);
        return -simulation.volume() * simulation.measured().stress * before / before.squaredNorm();
    }

    /// Steps on until the spheres have met and parted.
    void collide() {
        for (bool met = false;;) {
            const bool touching = simulation.advance(1).contacts > 0;
            if (met && !touching) return;
            met = met || touching;
        }
    }

    /// Moves the spheres so that the branch becomes `target`, then rests and returns the force on the first
    /// there. With a tiny time step what the force moves them meanwhile is lost in rounding.
    Eigen::Vector3d move_to(const Eigen::Vector3d& target) {
        set_relative_velocity((target - branch()) / simulation.time_step());
        simulation.advance(1);
        set_relative_velocity(Eigen::Vector3d::Zero());
        return step();
    }

    Simulation simulation;

  private:
    static Packing pack(const PairOptions& o) {
        const double largest = std::max(o.radius_0, o.radius_1);
        Packing packing;
        packing.cell = Eigen::Matrix3d::Identity() * 20 * largest;
        packing.centres.resize(3, 2);
        // Near a corner, so that the contact crosses the boundary.
        packing.centres.col(0) = largest * Eigen::Vector3d(19.5, 0.4, 19.6);
        packing.centres.col(1) = packing.centres.col(0) + (o.radius_0 + o.radius_1 + o.gap) * o.direction;
        packing.radii = Eigen::Vector2d(o.radius_0, o.radius_1);
        return packing;
    }
    static SimulationOptions how(const PairOptions& o) {
        SimulationOptions options;
        options.damping = o.damping;
        options.time_step_safety = o.safety;
        options.free_rotation = o.free_rotation;
        options.largest_overlap = o.largest_overlap;
        options.energy_balance = true;
        return options;
    }

    PairOptions options_;
    double mass_[2];
};

/// What an oblique impact leaves.
struct ObliqueRebound {
    double normal;         // velocity of the centres over the one before
    double tangential;     // change of the tangential velocity of the centres over -v_n
    double sideways;       // out of the plane of motion, over v_n
    double rotation;       // rotational energy over m_eff v_n^2
    Eigen::Vector2d spin;  // R · spin of each about n x t, over v_n
    double time_step;      // s
};

/// Two spheres without spin meet with the normal speed `speed` and a tangential one `ratio` times as large.
inline ObliqueRebound collide_obliquely(const ContactLaw& law, const PairOptions& pair, double speed,
                                        double ratio) {
    PairOptions o = pair;
    o.gap = 1e-9 * pair.radius_0;
    TwoSpheres spheres(law, o);
    const Eigen::Vector3d n = o.direction, t = n.cross(Eigen::Vector3d(0.3, 0.5, -0.2)).normalized();
    spheres.set_relative_velocity(speed * (ratio * t - n));
    spheres.collide();
    const Eigen::Vector3d after = spheres.relative_velocity();
    const Simulation& end = spheres.simulation;
    const double rotation = end.measured().kinetic_energy - spheres.energy_of_translation();
    const Eigen::Matrix3Xd spins = end.spins();
    const Eigen::Vector2d spin(o.radius_0 * spins.col(0).dot(n.cross(t)),
                               o.radius_1 * spins.col(1).dot(n.cross(t)));
    return {after.dot(n) / speed,
            ratio - after.dot(t) / speed,
            after.dot(n.cross(t)) / speed,
            rotation / (effective_mass(o.radius_0, o.radius_1, end.grain_density()) * speed * speed),
            spin / speed,
            end.time_step()};
}

}  // namespace loam::engine
