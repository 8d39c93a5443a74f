// The search for the hyper-parameters of a Gaussian process.
//
// They maximise the restricted likelihood (gp_likelihood.hpp) times a weak prior, by L-BFGS from several
// starts: the log of each length scale is normal about half that of d, with standard deviation 1. The
// diagonal of the cube is the length on which a smooth response to d inputs varies; the prior keeps small
// ensembles (n < 20 d) from mistaking a lack of contradiction for smoothness, which makes intervals too
// narrow, and is not felt in larger ones.
#pragma once

#include <cstdint>
#include <string>

#include "surrogate/gp_likelihood.hpp"

namespace loam::surrogate {

struct GaussianProcessOptions {
    std::string kernel = "matern52";  ///< a name of kernels/registry.hpp
    /// b [d], finite: the nugget's variance goes as exp(b . (x - 1/2)) over the inputs; empty: it stays.
    Eigen::VectorXd noise_slope{};
    int starts = 3;             ///< searches for the hyper-parameters, >= 1
    int max_evaluations = 150;  ///< of the likelihood, each search, >= 1
    /// Above this number of distinct inputs the starts compete on a random subset of this size, >= 50,
    /// and the winner alone is polished on all.
    int subset = 300;
    double relative_floor = 1e-8;  ///< noise variance always there, over the output's; in [1e-12, 1]
    std::uint64_t seed = 0;        ///< of the starts and the subset

    /// Throws std::invalid_argument naming field, value and constraint.
    void validate() const;
};

struct GaussianProcessSummary {
    std::string stopped_by = "not run";  ///< of the last search
    int searches = 0;                    ///< for hyper-parameters; 0 if these were given
    int evaluations = 0;                 ///< of the likelihood, all searches together
    double seconds = 0;
    double log_likelihood = 0;  ///< restricted, at the hyper-parameters, in the output's units
};

/// The best hyper-parameters for data whose runs have about zero mean and unit variance, noise floor
/// options.relative_floor; fills the summary except log_likelihood. Throws std::runtime_error if the
/// likelihood can nowhere be evaluated.
Hyperparameters search_hyperparameters(const KernelInfo& kernel, const GroupedData& data,
                                       const GaussianProcessOptions& options,
                                       GaussianProcessSummary& summary);

}  // namespace loam::surrogate
