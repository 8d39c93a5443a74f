// What a laboratory test adds to the behaviour of its specimen, as free functions of plain numbers: the
// device's own deformation, the bedding of the first stages, and friction on the ring of an oedometer. All of
// them leave the numbers as they are, bit for bit, where their strength is 0.
#pragma once

#include <Eigen/Core>

namespace loam::experiments {

/// Strain [n] that a device of this compliance (1/Pa) adds under the loads [n] (Pa): compliance · load.
Eigen::VectorXd device_strain(const Eigen::VectorXd& load, double compliance);

/// Strain [n] that bedding adds: amount (1 - exp(-load / scale)) of the largest load so far, since what has
/// bedded in does not come back on unloading. Loads [n] and scale in Pa.
Eigen::VectorXd bedding_strain(const Eigen::VectorXd& load, double amount, double scale);

/// Mean axial stress [n] (Pa) over the height of a specimen in a ring that bears a share of the stress on top
/// [n] (Pa) by friction. At full friction the stress falls from the top as exp(-beta z / H) where the
/// specimen is pushed down and rises as exp(+beta z / H) where it swells up, with beta = 4 K tan(delta) H / D
/// (Janssen 1895); between the two the friction turns round, and the mean stress stays. `seating`: stress
/// (Pa) at the start.
Eigen::VectorXd mean_ring_stress(const Eigen::VectorXd& top, double beta, double seating);

/// Values [n] at the readings x [n] (rising, above 0) of a curve through the origin whose reading k stands in
/// truth at x[k] + added[k]: by monotone cubic interpolation (Fritsch and Butland 1984).
Eigen::VectorXd at_shifted_readings(const Eigen::VectorXd& x, const Eigen::VectorXd& added,
                                    const Eigen::VectorXd& values);

}  // namespace loam::experiments
