// Squared-exponential kernel: k(r) = exp(-r^2 / 2); its derivative with respect to r^2 is -k / 2.
// Source: Rasmussen & Williams 2006, Gaussian Processes for Machine Learning, eq. 4.9.
#pragma once

#include <Eigen/Core>

namespace loam::surrogate {

inline void squared_exponential(const Eigen::Ref<const Eigen::ArrayXd>& squared_distance,
                                Eigen::Ref<Eigen::ArrayXd> value, Eigen::Ref<Eigen::ArrayXd> slope) {
    value = (-0.5 * squared_distance).exp();
    slope = -0.5 * value;
}

}  // namespace loam::surrogate
