// Semivariograms: how the half squared difference of a quantity grows with the distance of what predicts it,
// and the Gaussian model of it (Cressie 1992, "Statistics for spatial data").
#pragma once

#include <Eigen/Core>

namespace loam::surrogate {

struct ExperimentalSemivariogram {
    Eigen::VectorXd distance;  ///< [b] mean of the pairs in each bin, rising
    Eigen::VectorXd value;     ///< [b] half the mean squared difference
    Eigen::VectorXd pairs;     ///< [b] their number, > 0
};

/// gamma(h) = nugget + sill (1 - exp(-(h / range)^2)), 0 at h = 0.
struct GaussianSemivariogram {
    double nugget = 0, sill = 0, range = 1;  ///< range in the predictor's unit, > 0
    double at(double h) const;
};

/// Of values [n] over one predictor [n], in at most `bins` bins of equal width up to half the largest
/// distance. Throws std::invalid_argument for sizes that differ, fewer than 3 values or a constant predictor.
ExperimentalSemivariogram experimental_semivariogram(const Eigen::VectorXd& predictor,
                                                     const Eigen::VectorXd& values, int bins = 20);

/// Least squares weighted by the number of pairs; nugget and sill are not negative.
GaussianSemivariogram fit_gaussian(const ExperimentalSemivariogram& experimental);

}  // namespace loam::surrogate
