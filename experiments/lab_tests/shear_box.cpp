#include "experiments/lab_tests/shear_box.hpp"

namespace loam::experiments {

using Eigen::Vector3d;

namespace {

engine::Wall rectangle(const Vector3d& origin, const Vector3d& edge_a, const Vector3d& edge_b,
                       double friction_angle) {
    engine::Wall wall;
    wall.origin = origin;
    wall.edge_a = edge_a;
    wall.edge_b = edge_b;
    wall.friction_angle = friction_angle;
    wall.one_sided = true;
    return wall;
}

}  // namespace

ShearBox::ShearBox(engine::Simulation& simulation, const engine::Box& box, double gap, double travel,
                   double friction_angle)
    : plan_(box.area(2)),
      start_(box.low.x()),
      reach_(travel + 2 * simulation.mean_diameter()),
      friction_angle_(friction_angle) {
    const Vector3d sides = box.sides();
    const double middle = 0.5 * (box.low.z() + box.high.z()), r = reach_;
    add_half(simulation, box, box.low.z() - r, middle, lower_);
    add_half(simulation, box, middle + gap, box.high.z() + r, upper_);
    const Vector3d along_x(sides.x() + 2 * r, 0, 0), along_y(0, sides.y() + 2 * r, 0);
    const double x = box.low.x() - r, y = box.low.y() - r;
    const auto add = [&](const Vector3d& origin, const Vector3d& a, const Vector3d& b) {
        return simulation.add_wall(rectangle(origin, a, b, friction_angle));
    };
    bottom_ = add({x, y, box.low.z()}, along_x, along_y);
    platen_ = add({x, y, box.high.z()}, along_y, along_x);
    const Vector3d out(r, 0, 0);
    add({box.high.x(), y, middle}, out, along_y);             // carries what is pushed out
    upper_flange_ = add({x, y, middle + gap}, along_y, out);  // covers what is left behind
}

void ShearBox::add_half(engine::Simulation& simulation, const engine::Box& box, double low, double high,
                        std::array<std::size_t, 4>& walls) {
    const double r = reach_;
    const Vector3d along_x(box.sides().x() + 2 * r, 0, 0), along_y(0, box.sides().y() + 2 * r, 0),
        up(0, 0, high - low);
    const Vector3d corner(box.low.x() - r, box.low.y() - r, low);
    const auto add = [&](int axis, double at, const Vector3d& a, const Vector3d& b) {
        Vector3d origin = corner;
        origin[axis] = at;
        return simulation.add_wall(rectangle(origin, a, b, friction_angle_));
    };
    walls = {add(0, box.low.x(), along_y, up), add(0, box.high.x(), up, along_y),
             add(1, box.low.y(), up, along_x), add(1, box.high.y(), along_x, up)};
}

void ShearBox::move(engine::Simulation& simulation, double speed) const {
    const Vector3d velocity(speed, 0, 0);
    for (const std::size_t wall : upper_) simulation.set_wall_velocity(wall, velocity);
    simulation.set_wall_velocity(upper_flange_, velocity);
    simulation.set_wall_velocity(platen_, velocity);
}

double ShearBox::height(const engine::Simulation& simulation) const {
    return simulation.walls().wall(platen_).origin.z() - simulation.walls().wall(bottom_).origin.z();
}

double ShearBox::displacement(const engine::Simulation& simulation) const {
    return simulation.walls().wall(upper_[0]).origin.x() - start_;
}

double ShearBox::shear_force(const engine::Simulation& simulation) const {
    double force = simulation.walls().force(platen_).x() + simulation.walls().force(upper_flange_).x();
    for (const std::size_t wall : upper_) force += simulation.walls().force(wall).x();
    return -force;
}

double ShearBox::load_of_sides(const engine::Simulation& simulation) const {
    double force = -simulation.walls().force(upper_flange_).z();
    for (const std::size_t wall : upper_) force -= simulation.walls().force(wall).z();
    return force;
}

RoomyPacking with_room(const engine::Packing& packing, const engine::Box& box, double travel) {
    const double margin = 4 * packing.radii.maxCoeff();
    RoomyPacking out{packing, {}};
    const Vector3d sides = box.sides();
    out.packing.cell =
        Vector3d(sides.x() + travel + 2 * margin, sides.y() + 2 * margin, sides.z() + 2 * margin)
            .asDiagonal();
    out.packing.centres.colwise() += Vector3d::Constant(margin) - box.low;
    out.box.low = Vector3d::Constant(margin);
    out.box.high = out.box.low + sides;
    return out;
}

}  // namespace loam::experiments
