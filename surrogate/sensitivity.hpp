// Which input moves which output: Sobol's variance shares of a cheap model (an emulator) over a distribution
// of inputs.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <span>

#include "surrogate/priors.hpp"

namespace loam::surrogate {

struct SensitivityOptions {
    int samples = 2048;  ///< >= 16, best a power of two; the model is called samples * (d + 2) times
    std::uint64_t seed = 0;

    /// Throws std::invalid_argument naming field, value and constraint.
    void validate() const;
};

struct Sensitivity {
    Eigen::VectorXd mean;      ///< [m] of the outputs over the priors
    Eigen::VectorXd variance;  ///< [m]
    Eigen::MatrixXd first;  ///< [m x d] share of the variance due to an input alone; about 0 if it has none
    Eigen::MatrixXd total;  ///< [m x d] share that vanishes when all inputs but this one are held
    int evaluations = 0;    ///< of the model
};

/// Sobol indices of a model from x [d] in the unit cube to outputs [m], with inputs independent and
/// distributed as the priors' coordinates (priors.hpp). First order by Saltelli et al. 2010, eq. (b) of Table
/// 2, total by Jansen 1999, eq. (f), both on scrambled Sobol points in 2d dimensions. Outputs without
/// variance get indices 0. Throws std::invalid_argument for options, no priors or an invalid one.
Sensitivity sobol_indices(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& model,
                          std::span<const Prior> priors, const SensitivityOptions& options = {});

}  // namespace loam::surrogate
