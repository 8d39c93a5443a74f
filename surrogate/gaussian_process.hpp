// A Gaussian process for one output: an unknown constant plus a smooth function of d inputs in the unit cube,
// seen through noise. The noise of a run is a known variance, a learnt nugget, or both; repeated inputs cost
// nothing extra. Hyper-parameters are learnt as gp_search.hpp says.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>

#include "surrogate/gp_likelihood.hpp"
#include "surrogate/gp_search.hpp"
#include "surrogate/kernels/ard_covariance.hpp"

namespace loam::surrogate {

struct GaussianProcessPrediction {
    double mean = 0;
    double variance = 0;                ///< of the response itself, without the noise of a run
    Eigen::VectorXd mean_gradient;      ///< [d] with respect to x; empty if not asked for
    Eigen::VectorXd variance_gradient;  ///< [d] likewise
};

/// Each distinct input predicted from all the others, hyper-parameters kept; rows as in
/// GaussianProcess::data().
struct GaussianProcessLeaveOneOut {
    Eigen::VectorXd mean;      ///< [g] predicted
    Eigen::VectorXd variance;  ///< [g] of the response, without noise
    Eigen::VectorXd z;         ///< [g] (measured mean - predicted) / sd, with the noise of the measured mean
};

class GaussianProcess {
  public:
    /// Fits inputs [n x d], in or near the unit cube, and outputs [n]. `known_variance` is that of each run's
    /// noise [n], or empty for none. Throws std::invalid_argument for options, sizes or numbers out of range,
    /// or fewer than 3 distinct inputs; std::runtime_error if the likelihood can nowhere be evaluated.
    static GaussianProcess fit(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& outputs,
                               const GaussianProcessOptions& options = {},
                               const Eigen::VectorXd& known_variance = {});

    /// The same with hyper-parameters given.
    static GaussianProcess condition(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& outputs,
                                     const Hyperparameters& hyperparameters,
                                     const GaussianProcessOptions& options = {},
                                     const Eigen::VectorXd& known_variance = {});

    /// Prediction at x [d] (Rasmussen & Williams 2006, eqs 2.25, 2.26, and 2.42 for the unknown constant).
    GaussianProcessPrediction predict(const Eigen::Ref<const Eigen::VectorXd>& x,
                                      bool gradients = false) const;
    /// Means and variances [k] at the rows of points [k x d]: as predict(), up to rounding, several times
    /// faster.
    void predict_many(const Eigen::MatrixXd& points, Eigen::Ref<Eigen::VectorXd> mean,
                      Eigen::Ref<Eigen::VectorXd> variance) const;
    /// The mean alone, several times faster; its gradient [d] if gradient != nullptr.
    double predict_mean(const Eigen::Ref<const Eigen::VectorXd>& x,
                        Eigen::VectorXd* gradient = nullptr) const;
    /// Nugget variance of one run at x [d] (known variances, which belong to runs, are not in it).
    double noise_variance(const Eigen::Ref<const Eigen::VectorXd>& x) const;

    /// In closed form (Dubrule 1983): residual alpha_i / Q_ii with variance 1 / Q_ii.
    GaussianProcessLeaveOneOut leave_one_out() const;

    const Hyperparameters& hyperparameters() const { return hyperparameters_; }
    const GroupedData& data() const { return data_; }
    const GaussianProcessSystem& system() const { return system_; }
    const GaussianProcessSummary& summary() const { return summary_; }

  private:
    GaussianProcess(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& outputs,
                    const GaussianProcessOptions& options, const Eigen::VectorXd& known_variance);
    void set(const Hyperparameters& hyperparameters);

    const KernelInfo* kernel_;
    GroupedData data_;
    Eigen::VectorXd noise_slope_;  // [d]
    double centre_ = 0;  // mean of the outputs, not in data_: nothing is lost beside a large constant
    double floor_ = 0;   // relative_floor in the output's units
    Hyperparameters hyperparameters_;
    GaussianProcessSystem system_;
    std::optional<ArdCovariance> covariance_;  // of the inputs, at the hyper-parameters
    GaussianProcessSummary summary_;
};

}  // namespace loam::surrogate
