// Precompression stress of a compression curve.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace loam::experiments {

/// The stress (Pa) at the largest slope of a polynomial of degree 4 of strain over log stress, fitted to the
/// readings [n] and to points that continue the curve straight beyond both ends, so that the polynomial does
/// not turn there (De Pue et al. 2019, section 2.1; after Lamandé et al. 2017). None for fewer than four
/// readings.
std::optional<double> precompression_stress(const Eigen::VectorXd& stress, const Eigen::VectorXd& strain);

}  // namespace loam::experiments
