// Emulates a model whose answer is a whole curve of m numbers, from an ensemble of noisy runs.
//
// 1. A first look: principal components of the standardised curves, a Gaussian process each, fitted quickly,
//    give a first covariance of the noise along the curve; the same again on curves whitened by it tells
//    whether the noise changes over the inputs (log-linearly, where BIC prefers that; curve_noise.hpp).
// 2. The curves are whitened by that noise. Components whose variance is above what noise alone gives the
//    largest of m components in g inputs, (1 + sqrt(m / g))^2 (Marchenko & Pastur 1967; Johnstone 2001), are
//    emulated by a Gaussian process each, now carefully; and so are the next ones for as long as the inputs
//    explain them better than noise does (by BIC), for what shows at few of many inputs, at the edge of the
//    cube or beside a crowd about an estimate, hardly shows in the variance. The rest counts as noise.
// 3. The noise covariance is estimated anew.
// Components are independent of each other given the data. Emulation of curves by their principal components
// follows Higdon et al. 2008, "Computer model calibration using high-dimensional output".
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "surrogate/curve_noise.hpp"
#include "surrogate/gaussian_process.hpp"

namespace loam::surrogate {

struct CurveEmulatorOptions {
    std::string kernel = "matern52";  ///< a name of kernels/registry.hpp
    int max_components = 12;          ///< at most so many are emulated, >= 1
    bool noise_slope = true;          ///< allow noise that changes over the inputs
    int starts = 3;                   ///< for the hyper-parameters of each component, >= 1
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: as OpenMP says. The result does not depend on it

    /// Throws std::invalid_argument naming field, value and constraint.
    void validate() const;
};

struct CurveEmulatorSummary {
    std::string stopped_by = "not run";  ///< why no more components were taken
    Eigen::Index runs = 0;
    Eigen::Index inputs = 0;  ///< distinct ones
    Eigen::Index components = 0;
    double kept_variance = 0;  ///< share of the whitened curves' variance in the components
    int evaluations = 0;       ///< of likelihoods
    double seconds = 0;
};

struct CurvePrediction {
    Eigen::VectorXd mean;                 ///< [m]
    Eigen::MatrixXd emulator_covariance;  ///< [m x m] what the ensemble leaves open of the mean curve
    Eigen::MatrixXd noise_covariance;     ///< [m x m] of one run about the mean curve
};

/// Prediction of the q emulated components; curve mean = offset + loadings * mean.
struct ComponentPrediction {
    Eigen::VectorXd mean, variance;                    ///< [q]
    Eigen::MatrixXd mean_jacobian, variance_jacobian;  ///< [q x d]; empty if not asked for
};

/// Each distinct input predicted from all others (basis, hyper-parameters and noise kept).
struct CurveLeaveOneOut {
    Eigen::MatrixXd inputs;     ///< [g x d]
    Eigen::MatrixXd actual;     ///< [g x m] mean of the input's runs
    Eigen::MatrixXd predicted;  ///< [g x m]
    Eigen::MatrixXd
        z;  ///< [g x m] (actual - predicted) / sd, of emulator and of the noise of the actual mean
    Eigen::VectorXd rmse;      ///< [m]
    Eigen::VectorXd coverage;  ///< [m] share of inputs inside their central 90 % interval
};

class CurveEmulator {
  public:
    /// Inputs [n x d] in the unit cube, outputs [n x m], one run a row; rows of equal inputs are replicates.
    /// Throws std::invalid_argument for options or sizes, naming row and column of a number that is not
    /// finite, or for fewer than max(5, d + 2) distinct inputs.
    static CurveEmulator fit(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs,
                             const CurveEmulatorOptions& options = {});

    /// Prediction at x [d].
    CurvePrediction predict(const Eigen::Ref<const Eigen::VectorXd>& x) const;
    /// Mean [m] at x [d], and its jacobian [m x d] if jacobian != nullptr.
    Eigen::VectorXd predict_mean(const Eigen::Ref<const Eigen::VectorXd>& x,
                                 Eigen::MatrixXd* jacobian = nullptr) const;
    /// Means [q] of the components at x [d].
    Eigen::VectorXd predict_component_means(const Eigen::Ref<const Eigen::VectorXd>& x) const;
    /// Prediction at x [d] in the space of components.
    ComponentPrediction predict_components(const Eigen::Ref<const Eigen::VectorXd>& x,
                                           bool gradients = false) const;

    /// Means and variances [k x q] of the components at the rows of points [k x d].
    void predict_components(const Eigen::MatrixXd& points, Eigen::MatrixXd& mean,
                            Eigen::MatrixXd& variance) const;

    const Eigen::VectorXd& offset() const { return basis_.offset; }              ///< [m]
    auto loadings() const { return basis_.from_scores.leftCols(components()); }  ///< [m x q]
    Eigen::Index components() const { return static_cast<Eigen::Index>(processes_.size()); }
    const CurveNoise& noise() const { return noise_; }
    const std::vector<GaussianProcess>& processes() const { return processes_; }  ///< one a component
    const CurveEmulatorSummary& summary() const { return summary_; }

    CurveLeaveOneOut leave_one_out() const;
    /// Variance of each component [q] at an input, were it not among the runs: mean over the runs' inputs.
    /// What the emulator leaves open where it was trained, between its runs.
    Eigen::VectorXd typical_variance() const;

  private:
    ReplicateGroups groups_;
    Eigen::MatrixXd actual_;  // [g x m] mean curve of each input
    CurveBasis basis_;
    std::vector<GaussianProcess> processes_;
    CurveNoise noise_;
    CurveEmulatorSummary summary_;
};

}  // namespace loam::surrogate
