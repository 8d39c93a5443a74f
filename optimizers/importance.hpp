/// Weighted draws from a density on the unit cube whose value costs little for many points at once: for
/// posteriors by the thousand, where a Markov chain each would cost too much.
///
/// Adaptive multiple importance sampling (Cornuet, Marin, Mira & Robert 2012, Scand. J. Stat. 39, 798-812).
/// The first proposals come from points that the caller has already weighed (draws from the prior, say,
/// shared by many posteriors); each round fits a mixture of t distributions to what is known so far, draws
/// from it, and weighs all draws of all rounds by the mixture of all proposals. Everything happens in z =
/// Phi^-1(x), where a direction that the density leaves open is a standard normal; a share of every round is
/// drawn from that normal, so that no weight is unbounded where the mixture is too narrow.
#pragma once

#include "optimizers/problem.hpp"

namespace loam::optimizers {

/// Log densities [k], up to a constant, at the columns of points [d x k] inside the unit cube; not finite:
/// none.
using BatchDensity = std::function<Vector(const Matrix& points)>;

struct ImportanceOptions {
    int rounds = 3;          ///< >= 1
    int most_rounds = 8;     ///< further ones as the last follow while the effective number is too small
    double wanted = 100;     ///< effective number of draws
    int draws = 300;         ///< of every round but the last, >= 50
    int last_draws = 600;    ///< of the last, >= 50
    int components = 4;      ///< of a mixture at most, >= 1
    double defensive = 0.1;  ///< share of the draws from the standard normal in z, in (0, 1)
    std::uint64_t seed = 1;

    /// Throws std::invalid_argument naming field, value and constraint.
    void validate() const;
};

struct WeightedDraws {
    Matrix draws;          ///< [n x d], inside the unit cube
    Vector weight;         ///< [n], sum 1
    Vector log_density;    ///< [n] as the density gave them
    double effective = 0;  ///< number of draws, 1 / sum of squared weights
    Summary summary;

    /// n draws of equal weight, by systematic resampling; rows repeat where a weight is large.
    Matrix resampled(Eigen::Index n) const;
};

/// `first` [d x k], inside the unit cube, with log importance weights [k]. Throws std::invalid_argument for
/// unsound options, sizes or weights without a finite one; std::runtime_error when the density is finite at
/// no draw.
WeightedDraws sample_by_importance(const BatchDensity& log_density, const Matrix& first,
                                   const Vector& first_log_weight, const ImportanceOptions& options = {});

}  // namespace loam::optimizers
