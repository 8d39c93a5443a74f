// Squared-exponential kernel: k(r) = exp(-r^2 / 2); its derivative with respect to r^2 is -k / 2.
// Source: Rasmussen & Williams 2006, Gaussian Processes for Machine Learning, eq. 4.9.
#pragma once

namespace loam::surrogate {

/// Of and into arrays of Eigen's, whichever namespace it was compiled in.
template <class Array>
void squared_exponential(const Array& squared_distance, Array& value, Array& slope) {
    value = (-0.5 * squared_distance).exp();
    slope = -0.5 * value;
}

}  // namespace loam::surrogate
