// Spheres at random, without contacts: what packings are made from.
#pragma once

#include "engine/box.hpp"
#include "engine/packing.hpp"

namespace loam::engine {

/// Spheres without overlap in a cubic periodic cell, the largest first. Depends on the options' particles,
/// sizes and seed alone. Throws std::runtime_error when there is no room.
Packing make_cloud(const PackingOptions& options);

struct BoxedCloud {
    Packing packing;  // in a cell that leaves `margin` on every side of the box
    Box box;
};

/// The same between the walls of a box with sides in these proportions; `margin` over the box's longest side.
BoxedCloud make_boxed_cloud(const PackingOptions& options, const Eigen::Vector3d& proportions, double margin);

}  // namespace loam::engine
