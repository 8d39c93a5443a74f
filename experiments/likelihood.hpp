// How probable parameters are by the measured curves: residuals of an emulator, or of direct runs, with the
// covariance that fit.hpp states.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "experiments/fit.hpp"
#include "experiments/likelihood_terms.hpp"
#include "experiments/observation.hpp"
#include "experiments/parameter_space.hpp"

namespace loam::experiments {

/// Of theta [d + misfits], coordinates in the unit cube of the parameters and of the misfits' sizes. It keeps
/// references to all that it is made of.
class Likelihood {
  public:
    /// `packings`: so many runs at a set must come to an end.
    Likelihood(const TrainedEmulator& trained, const ParameterSpace& space, const Observation& observation,
               int packings, StrainMisfit strain = StrainMisfit::along);

    Eigen::Index parameters() const { return space_.dimension(); }
    Eigen::Index dimension() const { return parameters() + misfits(); }
    Eigen::Index misfits() const { return static_cast<Eigen::Index>(readings_.misfit_priors().size()); }
    const surrogate::Prior& misfit_prior_of(Eigen::Index which) const {
        return readings_.misfit_priors()[static_cast<std::size_t>(which)];
    }
    /// The misfits' sizes [misfits] at theta.
    Eigen::VectorXd misfits_at(const Eigen::VectorXd& theta) const;

    /// Of the residuals [m x m], with `open` [q] the variance of each component that the emulator leaves
    /// open.
    Eigen::MatrixXd covariance(const Eigen::VectorXd& theta, const Eigen::VectorXd& open) const;

    /// Variance of each component [q] that the emulator leaves open at theta.
    Eigen::VectorXd open_at(const Eigen::VectorXd& theta) const;
    /// The same at a typical place between the runs.
    Eigen::VectorXd typical_variance() const { return trained_.emulator.typical_variance(); }
    /// What `open` [q] adds to the variances of all readings together.
    double emulator_variance(const Eigen::VectorXd& open) const {
        return (loadings_.cwiseAbs2() * open).sum();
    }

    double log_posterior(const Eigen::VectorXd& theta) const;

    /// As if the emulator left `open` [q] at every theta: what is likely where it knows as much everywhere. A
    /// search by it is not drawn to where the emulator knows nothing and so excludes nothing.
    double log_representative(const Eigen::VectorXd& theta, const Eigen::VectorXd& open) const;

    /// As it is expected to be, were the emulator's curve known. The estimate is sought by it: by the mean
    /// curve alone a search ends where the emulator's error flatters, by the posterior where it knows
    /// nothing.
    double log_expected(const Eigen::VectorXd& theta) const;

    /// With the mean curve [m] of `runs` direct runs at theta in place of the emulator's.
    double log_by_runs(const Eigen::VectorXd& theta, const Eigen::VectorXd& mean, double runs) const;

    /// Residuals [m + d] at x [d] whitened by a covariance, with the priors of the parameters as further
    /// residuals; their derivatives [m + d x d] unless nullptr.
    void residuals(const Eigen::VectorXd& x, const Eigen::LLT<Eigen::MatrixXd>& factor, Eigen::VectorXd& out,
                   Eigen::MatrixXd* jacobian) const;

  private:
    double log_prior(const Eigen::VectorXd& theta) const;
    double log_posterior(const Eigen::VectorXd& theta, const Eigen::VectorXd& components,
                         const Eigen::VectorXd& open) const;
    /// For a model whose mean curve [m] is known but for `open` [q], and differs from the measured specimens
    /// by `packings` times the variance of a run.
    /// `expected`: see log_expected.
    double log_density(const Eigen::VectorXd& theta, const Eigen::VectorXd& mean, const Eigen::VectorXd& open,
                       double packings, bool expected = false) const;
    /// The emulator gives the mean of T over packings. A specimen of more grains averages the curve itself
    /// over as many packings, whose T is larger by half the variance that has been averaged out (lognormal
    /// scatter; a linear T stays).
    Eigen::VectorXd large_specimen(double noise_scale) const { return noise_scale * large_specimen_; }

    const TrainedEmulator& trained_;
    const ParameterSpace& space_;
    const Observation& observation_;
    ReadingNoise readings_;
    int packings_;
    Eigen::VectorXd most_open_;                // [q]
    Eigen::MatrixXd loadings_;                 // [m x q]
    Eigen::VectorXd target_, large_specimen_;  // [m] at noise of scale 1
};

}  // namespace loam::experiments
