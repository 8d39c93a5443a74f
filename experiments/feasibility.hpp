// Where in parameter space virtual tests come to an end: those that fail (contacts too soft for the stress,
// say) tell that no soil which was tested is like that.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace loam::experiments {

/// Logistic regression of a run's success on its parameters in the unit cube, with all their products of
/// second degree and a ridge.
class Feasibility {
  public:
    /// Nothing is known: success is certain everywhere.
    Feasibility() = default;
    /// `x` [n x d]; `success` [n]. Where all runs succeeded, or none did, nothing is known either.
    Feasibility(const Eigen::MatrixXd& x, const std::vector<bool>& success);

    /// Logarithm of the probability of success at x [d].
    double log_success(const Eigen::VectorXd& x) const;

  private:
    Eigen::VectorXd weights_;  // of 1, x_i, x_i x_j; empty: nothing is known
};

}  // namespace loam::experiments
