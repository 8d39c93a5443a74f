// A box of six rigid walls along the axes, as triaxial and oedometer tests have it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "engine/simulation.hpp"

namespace loam::engine {

struct Box {
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Ones();  // m

    Eigen::Vector3d sides() const { return high - low; }
    double volume() const { return sides().prod(); }
    double area(int axis) const { return volume() / sides()[axis]; }  // of one face normal to the axis (m²)
};

/// The walls' numbers: low and high x, low and high y, low and high z.
using BoxWalls = std::array<std::size_t, 6>;

/// Adds the six walls and takes the box as the reference volume. The walls reach beyond the box on every side
/// by its longest side, so that they may move, and a particle outside ends the run. Throws
/// std::invalid_argument.
BoxWalls add_box(Simulation& simulation, const Box& box, double friction_angle = 0);

/// Where the walls are now.
Box present_box(const Simulation& simulation, const BoxWalls& walls);

/// Normal force on the two walls of each axis over their area, mean of the two, in the last step (Pa).
Eigen::Vector3d box_pressures(const Simulation& simulation, const BoxWalls& walls);

}  // namespace loam::engine
