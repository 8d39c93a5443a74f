// Packings between the six walls of a box.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "engine/box.hpp"
#include "engine/packing.hpp"

namespace loam::engine {

struct BoxedPackingOptions : PackingOptions {
    Eigen::Vector3d proportions = Eigen::Vector3d::Ones();  // of the box's sides
    // Room for the walls' motion between the box and the faces of its cell, on every side, over the box's
    // longest side.
    double margin = 0.15;

    void validate() const;
};

struct BoxedPackingResult : PackingResult {
    Box box;  // the porosity is that of the box
};

/// make_packing between walls without friction, which move with the spheres' mean field.
BoxedPackingResult make_boxed_packing(const BoxedPackingOptions& options,
                                      const std::function<bool()>& cancelled = {});

}  // namespace loam::engine
