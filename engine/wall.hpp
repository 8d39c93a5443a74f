// A rigid wall: a finite rectangle, of which a plane is a large one.
#pragma once

#include <Eigen/Core>

namespace loam::engine {

/// A sphere touches a wall at the rectangle's point nearest to its centre, from either side: the face, an
/// edge or a corner. Walls do not turn. Their centres move like particles, with the mean velocity field L·x
/// and their own velocity relative to it.
struct Wall {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();   // a corner (m)
    Eigen::Vector3d edge_a = Eigen::Vector3d::UnitX();  // from there along the edges, at right angles (m)
    Eigen::Vector3d edge_b = Eigen::Vector3d::UnitY();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
    double friction_angle = 0;                           // against particles (rad)
    bool one_sided = false;  // a particle behind the rectangle, seen along the normal, ends the run

    /// The part of the plane through `point` with this normal (of any length) that reaches at least `extent`
    /// (m) from the point along two directions. Throws std::invalid_argument.
    static Wall plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double extent);

    /// Throws std::invalid_argument naming field, value, constraint.
    void validate() const;

    Eigen::Vector3d centre() const { return origin + 0.5 * (edge_a + edge_b); }
    Eigen::Vector3d normal() const;  // unit vector along edge_a × edge_b
    Eigen::Vector3d nearest(const Eigen::Vector3d& point) const;
    double area() const;
};

/// What makes a wall follow a force, step by step: its speed along its normal is missing·speed_per_force +
/// mean of the speeds so far, within the limit. Being a mean of limited speeds, that part does not wind up.
struct WallDrive {
    double force = 0;            // that contacts press on the wall with, against its normal (N)
    double speed_per_force = 0;  // m/s/N; 0: no drive
    double mean_over = 1;        // steps, >= 1
    double limit = 0;            // m/s

    void validate() const;  // throws std::invalid_argument
};

}  // namespace loam::engine
