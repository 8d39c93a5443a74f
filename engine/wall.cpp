#include "engine/wall.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "engine/require.hpp"

namespace loam::engine {

Wall Wall::plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double extent) {
    require(normal.allFinite() && normal.norm() > 0, "wall normal", normal.norm(), "a vector of some length");
    require(extent > 0, "wall extent", extent, "positive (m)");
    const Eigen::Vector3d n = normal.normalized();
    Eigen::Index thinnest = 0;
    n.cwiseAbs().minCoeff(&thinnest);
    const Eigen::Vector3d a = n.cross(Eigen::Vector3d::Unit(thinnest)).normalized(), b = n.cross(a);
    Wall out;
    out.origin = point - extent * (a + b);
    out.edge_a = 2 * extent * a;
    out.edge_b = 2 * extent * b;
    return out;
}

void Wall::validate() const {
    if (!origin.allFinite() || !edge_a.allFinite() || !edge_b.allFinite() || !velocity.allFinite())
        throw std::invalid_argument("wall: origin, edges and velocity must be finite");
    const double a = edge_a.norm(), b = edge_b.norm();
    require(a > 0, "wall edge_a", a, "of some length (m)");
    require(b > 0, "wall edge_b", b, "of some length (m)");
    const double cosine = edge_a.dot(edge_b) / (a * b);
    require(std::abs(cosine) < 1e-9, "cosine of the angle between the edges of a wall", cosine,
            "0: a wall is a rectangle");
    require(friction_angle >= 0 && friction_angle < 0.5 * std::numbers::pi, "wall friction_angle",
            friction_angle, "within 0..pi/2 (rad)");
}

Eigen::Vector3d Wall::normal() const {
    return edge_a.cross(edge_b).normalized();
}

Eigen::Vector3d Wall::nearest(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = point - origin;
    const double s = std::clamp(d.dot(edge_a) / edge_a.squaredNorm(), 0.0, 1.0),
                 t = std::clamp(d.dot(edge_b) / edge_b.squaredNorm(), 0.0, 1.0);
    return origin + s * edge_a + t * edge_b;
}

double Wall::area() const {
    return edge_a.norm() * edge_b.norm();
}

void WallDrive::validate() const {
    require(std::isfinite(force), "force of a wall drive", force, "finite (N)");
    require(std::isfinite(speed_per_force) && speed_per_force >= 0, "speed_per_force of a wall drive",
            speed_per_force, ">= 0 (m/s/N)");
    require(mean_over >= 1, "mean_over of a wall drive", mean_over, ">= 1 (steps)");
    require(std::isfinite(limit) && limit >= 0, "limit of a wall drive", limit, ">= 0 (m/s)");
}

}  // namespace loam::engine
