/// Are these chains draws from one distribution, and how many independent draws are they worth?
///
/// After Vehtari, Gelman, Simpson, Carpenter & Bürkner 2021, "Rank-normalization, folding, and localization:
/// an improved R-hat", Bayesian Analysis 16, 667-718. Each function takes one quantity as `chains` [n x c]: n
/// >= 4 draws in order from each of c >= 1 chains, and halves the chains, so that a drift within a chain
/// shows too. Chains that are all one constant say nothing: R-hat and effective sizes are NaN.
#pragma once

#include "optimizers/problem.hpp"

namespace loam::optimizers {

/// Rank-normalised split R-hat, the greater of that of the values (location) and that of their distances from
/// the median (spread). Near 1 when the chains agree; below 1.01 is good enough to use.
double split_rhat(const Matrix& chains);

/// Effective number of draws for the centre: of the mean of the rank-normalised draws, from autocorrelations
/// within and between the chains, summed up to Geyer's (1992) initial monotone sequence.
double bulk_effective_size(const Matrix& chains);

/// Effective number of draws for the 5 % and the 95 % quantile, the smaller of the two.
double tail_effective_size(const Matrix& chains);

/// The p-quantile (0 <= p <= 1) of a sample of at least one value, linear between order statistics (type 7 of
/// Hyndman & Fan 1996).
double quantile(Vector sample, double p);

/// The p-quantile of each column of draws [n x d]: [d].
Vector quantiles(const Matrix& draws, double p);

}  // namespace loam::optimizers
