// Designs of experiments: where in the unit cube the expensive model is run.
// A maximin Latin hypercube for a first ensemble of known size, a scrambled Sobol sequence for one that may
// grow. Points are probabilities; a prior's quantile maps them to the fitted parameters.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

namespace loam::surrogate {

/// Latin hypercube of n points in d dimensions, [n x d]: each column holds the cell centres (i + 1/2) / n
/// once. The cells are chosen to spread the points: swaps within a column that lower the phi_p criterion, the
/// sum over all pairs of distance^-20, for a number of swaps bounded so that n = 1000, d = 5 takes well under
/// a second. Source: Morris & Mitchell 1995, "Exploratory designs for computational experiments", eq. 3.
/// Throws std::invalid_argument unless n >= 1 and d >= 1.
Eigen::MatrixXd maximin_latin_hypercube(Eigen::Index n, Eigen::Index d, std::uint64_t seed);

struct SobolOptions {
    std::uint64_t seed = 0;
    std::uint32_t skip = 0;  ///< index of the first point; to continue a sequence, the points made before
    bool scramble = true;    ///< off: the plain sequence, whose first point is the corner 0
};

/// Points skip, …, skip + n - 1 of the Sobol sequence in d dimensions, [n x d], inside (0,1) when scrambled.
/// The scrambling is nested (Owen 1995) by hashing: any 2^k points from a multiple of 2^k on stay stratified,
/// and each point is uniform. Source: Burley 2020, "Practical hash-based Owen scrambling", JCGT 9(4). Throws
/// std::invalid_argument unless n >= 1, 1 <= d <= 1000 and skip + n <= 2^31.
Eigen::MatrixXd sobol_sequence(Eigen::Index n, Eigen::Index d, const SobolOptions& options = {});

}  // namespace loam::surrogate
