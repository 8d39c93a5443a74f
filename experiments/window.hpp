// Parts of the unit cube in which parameters are plausible.
#pragma once

#include <Eigen/Core>

namespace loam::experiments {

/// A part of the unit cube, bounds [d].
struct Window {
    Eigen::VectorXd lower, upper;
};

/// The bounds of `draws` [n x d] but for a thousandth at either end, wider by half of their distance and by
/// 0.03 of the cube, which they do not leave. Expects n > 0.
Window window_about(const Eigen::MatrixXd& draws);

/// The least window that holds both.
Window hull(const Window& a, const Window& b);

}  // namespace loam::experiments
