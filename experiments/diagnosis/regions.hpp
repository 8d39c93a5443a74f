// The regions of a test's curves, declared from the kind of test and the model's own curve, before any
// residual is looked at. Oedometer: low, middle and high stress of the first loading, unloading, reloading.
// Triaxial and direct shear: of the stress initial, peak, softening and residual; of the volume contraction
// and dilation.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "experiments/diagnosis/locate.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// One channel of one test.
struct RegionCurve {
    std::string test, channel;
    lab_data::TestKind kind;
    Eigen::Index first = 0;          // its place among the model's outputs
    Eigen::VectorXd x;               // [n] axial stress (Pa), axial strain or shear displacement
    Eigen::VectorXd model;           // [n] the model's curve
    std::vector<std::string> phase;  // [n] of an oedometer; empty: all loading
};

/// Regions that hold at least one reading.
std::vector<Region> regions_of(const RegionCurve& curve);

}  // namespace loam::experiments
