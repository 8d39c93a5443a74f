// Matern kernel of smoothness 5/2: k(r) = (1 + a + a^2 / 3) exp(-a) with a = sqrt(5) r.
// Its derivative with respect to r^2 is -(5/6) (1 + a) exp(-a), smooth down to r = 0.
// Source: Rasmussen & Williams 2006, Gaussian Processes for Machine Learning, eq. 4.17.
#pragma once

namespace loam::surrogate {

/// Of and into arrays of Eigen's, whichever namespace it was compiled in.
template <class Array>
void matern52(const Array& squared_distance, Array& value, Array& slope) {
    value = (5 * squared_distance).sqrt();
    slope = (-value).exp();
    // In place, to keep prediction free of allocations: slope holds exp(-a) until the last line.
    value = (1 + value + (5.0 / 3) * squared_distance) * slope;
    slope = (-5.0 / 6) * (1 + (5 * squared_distance).sqrt()) * slope;
}

}  // namespace loam::surrogate
