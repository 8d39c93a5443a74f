// What every comparison of a measured curve with an emulator's is made of: the noise of readings, the misfit
// of the model, and the priors as residuals of a least-squares problem (see fit.hpp).
#pragma once

#include <Eigen/Core>

#include "experiments/fit.hpp"
#include "experiments/residual_factor.hpp"

namespace loam::experiments {

/// How the misfit of strains is correlated. `along`: along the strain gone through. `nearest`: not at all, so
/// that a set is the more probable the nearer its strains are, but that unloading and reloading are compared
/// by the strain since they began, as they else would count the error at the end of loading once more a
/// reading. Where less strain leads to a reading of theirs than to one of loading, its variance is larger in
/// proportion, up to a hundredfold: four readings of a small rebound are not half as much as eight of the
/// curve before it.
enum class StrainMisfit { along, nearest };

/// What measurement and misfit add to the covariance of an observation's residuals, and what packing noise
/// its specimens share; all on the transformed scale.
class ReadingNoise {
  public:
    /// `transforms` [m].
    ReadingNoise(const Observation& observation, const std::vector<OutputTransform>& transforms,
                 StrainMisfit strain = StrainMisfit::along);

    const std::vector<surrogate::Prior>& misfit_priors() const { return misfit_priors_; }
    /// Adds measurement and misfit, of these sizes [misfits], to the block
    /// c [n x n] of the covariance that begins at reading `first` and cuts no curve; to all of it by default.
    void add(const Eigen::VectorXd& misfits, Eigen::MatrixXd& c, Eigen::Index first = 0) const;
    /// The readings of each specimen, whose noises of packing are independent of each other.
    const std::vector<Stretch>& specimens() const { return specimens_; }
    /// The packing noise of one run [m x m] without what different specimens have in common there.
    Eigen::MatrixXd of_specimens(const Eigen::MatrixXd& packing_noise) const;

  private:
    std::vector<ObservedCurve> curves_;
    std::vector<surrogate::Prior> misfit_priors_;
    std::vector<Eigen::MatrixXd> correlations_;  // of the misfit along each curve; empty: independent
    Eigen::VectorXd slope_, measurement_;        // [m] dT/dy; variance of a reading (SI)
    std::vector<Stretch> specimens_;
};

/// Variance [m] of each reading about the model's curve, on the transformed scale, from measurement and
/// misfit (SI).
Eigen::VectorXd reading_variance(const Observation& observation, const OutputTransform& transform,
                                 double misfit);

/// The priors of the parameters at x [d] as residuals (their squares sum to -2 log density up to a constant)
/// in rows first .. first + d of `out` and, if not nullptr, of `jacobian` [rows x d].
void prior_residuals(const ParameterSpace& space, const Eigen::VectorXd& x, Eigen::Index first,
                     Eigen::VectorXd& out, Eigen::MatrixXd* jacobian);

}  // namespace loam::experiments
