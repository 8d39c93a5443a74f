// Walls in a simulation (simulation.hpp).
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "engine/kernel/kernel.hpp"
#include "engine/require.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

void check_number(std::size_t wall, std::size_t walls) {
    if (wall >= walls)
        throw std::invalid_argument("wall " + std::to_string(wall) + ": there are " + std::to_string(walls) +
                                    ", counted from 0");
}

}  // namespace

std::size_t Simulation::add_wall(const Wall& wall) {
    walls_.add(wall);
    drift_since_check_ = 1e300;  // forces a rebuild
    return walls_.size() - 1;
}

void Simulation::set_wall_velocity(std::size_t wall, const Eigen::Vector3d& velocity) {
    check_number(wall, walls_.size());
    walls_.set_velocity(wall, velocity);
}

void Simulation::drive_wall(std::size_t wall, const WallDrive& drive) {
    check_number(wall, walls_.size());
    walls_.drive(wall, drive);
}

void Simulation::set_reference_volume(double volume) {
    require(std::isfinite(volume) && volume > 0, "reference volume", volume, "positive (m3)");
    reference_volume_ = volume;
}

/// The contacts of every wall, in the loop that those of the particles go through; `a` is what that loop had.
void Simulation::wall_forces(ContactArguments a, ContactSums& sums, Measure measure) {
    walls_.place_feet(particles_.data(), gradient_);
    a.law = composition_.at_wall;
    for (std::size_t k = 0; k < walls_.size(); ++k) {
        point_to(walls_.pairs(k), 0, walls_.pairs(k).padded(), a);
        a.law.friction_coefficient = walls_.friction_coefficient(k);
        ContactSums of_wall{};
        contact_loop(measure)(a, of_wall);
        if (measure == Measure::all) walls_.record(k, of_wall);
        of_wall.contacts = 0;  // pairs of particles alone are counted
        if (measure != Measure::nothing) sums += of_wall;
    }
    sums.power += walls_.take_forces(particles_.data(), forces_.data());
}

/// Particles between walls must not meet their periodic copies.
void Simulation::check_enclosed() const {
    const Eigen::Matrix3d inverse = cell_.inverse();
    for (std::size_t p = 0; p < count_; ++p) {
        const double* x = particles_[p].x;
        const Eigen::Vector3d f = inverse * Eigen::Vector3d(x[0], x[1], x[2]);
        for (int k = 0; k < 3; ++k) {
            const double margin = particles_[p].radius * inverse.row(k).norm();
            if (f[k] > margin && f[k] < 1 - margin) continue;
            throw std::runtime_error("particle " + std::to_string(outside_[p]) +
                                     " is not between the walls: it has come to the face of the cell at (" +
                                     std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " +
                                     std::to_string(x[2]) + ") m");
        }
    }
}

}  // namespace loam::engine
