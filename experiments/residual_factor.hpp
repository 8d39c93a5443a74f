// The covariance of a fit's residuals in the form that it has: blocks of specimens, which share nothing, plus
// what the emulator leaves open along its few components. Factored in that form, a density of 200 readings of
// seven tests costs a twentieth of what the dense matrix does, and a posterior takes tens of thousands.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace loam::experiments {

/// Readings `first` .. `first + count` of an observation.
struct Stretch {
    Eigen::Index first = 0, count = 0;
};

/// Log density, up to the constant of the number of readings, of normal residuals with the covariance
/// blocks + loadings diag(variance) loadings', built block by block.
class ResidualFactor {
  public:
    /// `loadings` [m x q] and `variance` [q], the components' own; `residuals` [m]. They must outlive it.
    ResidualFactor(const Eigen::MatrixXd& loadings, const Eigen::VectorXd& variance,
                   const Eigen::VectorXd& residuals);

    /// Adds the block [count x count] of a stretch, which is overwritten by its factor. False if it is not
    /// positive definite.
    bool add(Stretch at, Eigen::MatrixXd& block);

    /// -(log det C + r' C^-1 r) / 2 of what was added; empty if C is not positive definite.
    std::optional<double> log_density() const;

    /// -(log det B + E[r' B^-1 r]) / 2, B being the blocks alone and the mean taken over what the emulator
    /// leaves open: the log density as it is expected to be, were the emulator's curve known. Ignorance only
    /// lowers it.
    double expected_log_density() const;

  private:
    const Eigen::MatrixXd& loadings_;
    const Eigen::VectorXd& residuals_;
    Eigen::VectorXd root_;              // [q] sd of the components
    double log_det_ = 0, squares_ = 0;  // of the blocks alone
    Eigen::MatrixXd gram_;              // [q x q] I + root loadings' blocks^-1 loadings root (lower part)
    Eigen::VectorXd projected_;         // [q] root loadings' blocks^-1 r
    Eigen::MatrixXd white_;             // room for the whitened loadings and residuals of a block
};

}  // namespace loam::experiments
