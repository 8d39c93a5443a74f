#include "engine/box.hpp"

#include "engine/require.hpp"

namespace loam::engine {

using Eigen::Vector3d;

BoxWalls add_box(Simulation& simulation, const Box& box, double friction_angle) {
    const Vector3d sides = box.sides();
    require(sides.allFinite() && sides.minCoeff() > 0, "shortest side of the box", sides.minCoeff(),
            "positive (m)");
    BoxWalls walls{};
    for (int axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true}) {
            Vector3d middle = 0.5 * (box.low + box.high);
            middle[axis] = high ? box.high[axis] : box.low[axis];
            Wall wall =
                Wall::plane(middle, (high ? -1.0 : 1.0) * Vector3d::Unit(axis), 1.5 * sides.maxCoeff());
            wall.friction_angle = friction_angle;
            wall.one_sided = true;
            walls[static_cast<std::size_t>(2 * axis + (high ? 1 : 0))] = simulation.add_wall(wall);
        }
    simulation.set_reference_volume(box.volume());
    return walls;
}

Box present_box(const Simulation& simulation, const BoxWalls& walls) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto first = static_cast<std::size_t>(2 * axis);
        box.low[axis] = simulation.walls().wall(walls[first]).origin[axis];
        box.high[axis] = simulation.walls().wall(walls[first + 1]).origin[axis];
    }
    return box;
}

Vector3d box_pressures(const Simulation& simulation, const BoxWalls& walls) {
    const Box box = present_box(simulation, walls);
    Vector3d pressures;
    for (int axis = 0; axis < 3; ++axis) {
        const auto first = static_cast<std::size_t>(2 * axis);
        const double low = -simulation.walls().force(walls[first])[axis],
                     high = simulation.walls().force(walls[first + 1])[axis];
        pressures[axis] = 0.5 * (low + high) / box.area(axis);
    }
    return pressures;
}

}  // namespace loam::engine
