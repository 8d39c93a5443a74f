// The scatter of whole curves from run to run at one input (another packing of grains, say), with its
// correlation along the curve, and how it is learnt from three sources at once: replicates, what the Gaussian
// processes leave unexplained, and the directions that are not emulated.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "surrogate/curve_basis.hpp"
#include "surrogate/gaussian_process.hpp"
#include "surrogate/replicates.hpp"

namespace loam::surrogate {

/// covariance(x) = centre * exp(slope . (x - 1/2)): the noise keeps its shape along the curve, and its size
/// may change over the inputs.
struct CurveNoise {
    Eigen::MatrixXd centre;  ///< [m x m] of one run's outputs at the centre of the cube, positive definite
    Eigen::VectorXd slope;   ///< [d] of the logarithm of the variance; zero if it does not change

    double scale(const Eigen::Ref<const Eigen::VectorXd>& x) const;
    /// [m x m] at x [d].
    Eigen::MatrixXd covariance(const Eigen::Ref<const Eigen::VectorXd>& x) const { return scale(x) * centre; }
};

/// What an ensemble says about the noise: all scores of all rows [n x m], and the processes that were fitted
/// to the first of them.
struct NoiseEvidence {
    const ReplicateGroups& groups;
    const Eigen::MatrixXd& scores;
    const std::vector<GaussianProcess>& processes;
};

/// How the log of the noise variance changes over the inputs, [d], zero unless BIC prefers a slope; from
/// processes fitted without one. One slope for all scores, from the same sources as the covariance below.
Eigen::VectorXd estimate_noise_slope(const NoiseEvidence& evidence);

/// Covariance of the outputs [m x m] at the centre of the cube, given the slope [d] of its logarithm and
/// from_scores [m x m] of the basis.
/// Levels of the scores: a process's nugget; beyond the processes, the scores' whole variance (which holds
/// the signal that is not emulated), drawn to their mean as far as their spread is chance (after Ledoit &
/// Wolf 2004). Correlations: moments of the residuals of processes and further scores, and of the replicates'
/// deviations, all in units of their level, unbiased for a given smoothness of the processes; drawn to zero
/// as far as their spread is chance; eigenvalues below 0.05 are raised. Variances of the outputs: scaled to
/// what the same moments, not drawn to anything, say of them. Outputs vary as sums over all pairs of scores,
/// so that correlations each too small to be believed add up to much of it.
Eigen::MatrixXd estimate_noise_covariance(const NoiseEvidence& evidence, const Eigen::VectorXd& slope,
                                          const Eigen::MatrixXd& from_scores);

/// Slope b [d] of log v in s_g ~ v exp(b . (x_g - 1/2)) chi^2(freedom_g), for sums of squares s [g] at inputs
/// [g x d]; maximum likelihood with the level v profiled out, at most 8 in size, and zero unless BIC prefers
/// it.
Eigen::VectorXd log_variance_slope(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& squares,
                                   const Eigen::VectorXd& freedom);

}  // namespace loam::surrogate
