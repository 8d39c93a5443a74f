// How well hyper-parameters explain the data of one Gaussian process: the restricted likelihood, in which the
// constant mean is integrated out under a flat prior, with its analytic gradient.
//
// Model: y_r = mu + f(x_g) + e_r for each row r of group g; f has an ARD kernel; e_r is normal with variance
// v_g = floor + known_g + nugget * factor_g. With K the covariance of the groups' means y (noise v_g / k_g),
// S_g the groups' scatter, Q = K^-1 - K^-1 1 1' K^-1 / (1' K^-1 1) and alpha = Q y, the log likelihood of all
// N rows is, exactly,
//   -1/2 [ (N - 1) log 2 pi + log|K| + log(1' K^-1 1 / N) + y' Q y
//          + sum_g (k_g - 1) log v_g + log k_g + S_g / v_g ]
// and its derivative along dK is 1/2 tr((alpha alpha' - Q) dK), to which the scatter adds its own.
// Sources: Rasmussen & Williams 2006, eqs 2.45 and 5.9; Patterson & Thompson 1971 (restricted likelihood);
// Binois, Gramacy & Ludkovski 2018, eq. 8 (replicates).
#pragma once

#include <Eigen/Dense>

#include "surrogate/kernels/ard_covariance.hpp"

namespace loam::surrogate {

/// Of one Gaussian process, in the units of its output.
struct Hyperparameters {
    double variance = 1;            ///< of the response about its mean
    Eigen::VectorXd length_scales;  ///< [d] in the unit cube
    double nugget = 0;              ///< noise variance of one run where the noise factor is 1

    /// (log variance, log lengths [d], log nugget) and back.
    Eigen::VectorXd to_log() const;
    static Hyperparameters from_log(const Eigen::VectorXd& log);
};

/// Runs gathered by their input.
struct GroupedData {
    Eigen::MatrixXd inputs;          ///< [g x d], distinct
    Eigen::VectorXd mean;            ///< [g]
    Eigen::VectorXd count;           ///< [g], >= 1
    Eigen::VectorXd scatter;         ///< [g] sum of squares about the mean
    Eigen::VectorXd known_variance;  ///< [g] of one run
    Eigen::VectorXd noise_factor{};  ///< [g] of the nugget's variance
};

/// The linear system of a Gaussian process at given hyper-parameters; notation of the head of this file.
struct GaussianProcessSystem {
    Eigen::MatrixXd inverse_factor;  ///< L^-1 [g x g] with K = L L'
    Eigen::VectorXd noise;           ///< v [g], of one run
    Eigen::VectorXd alpha;           ///< Q y [g]
    Eigen::VectorXd ones;            ///< K^-1 1 [g]
    double mean = 0;                 ///< mu, generalised least squares
    double mean_precision = 0;       ///< 1' K^-1 1
    double log_likelihood = 0;

    /// Lower triangle of Q [g x g].
    void q_matrix(Eigen::MatrixXd& q) const;
    /// Diagonal of Q [g].
    Eigen::VectorXd q_diagonal() const;
};

/// Log likelihood of the same data were there no response but a constant, and all else noise, its nugget the
/// likeliest; data.known_variance counts as 0. What a process's own likelihood exceeds this by is the
/// evidence that the inputs matter.
double constant_log_likelihood(const GroupedData& data);

class RestrictedLikelihood {
  public:
    /// `floor`, a variance, keeps K invertible; kernel and data outlive this object. Not for several threads
    /// at once.
    RestrictedLikelihood(const KernelInfo& kernel, const GroupedData& data, double floor)
        : kernel_(kernel), data_(data), floor_(floor) {}

    /// The system at these hyper-parameters; false if K is not positive definite to rounding.
    bool solve(const Hyperparameters& at, GaussianProcessSystem& system);

    /// Log likelihood at log hyper-parameters (to_log()), NaN if K is not positive definite; with its
    /// gradient.
    double value(const Eigen::VectorXd& log_parameters, Eigen::VectorXd* gradient);

  private:
    bool solve(const ArdCovariance& covariance, double nugget, GaussianProcessSystem& system);

    const KernelInfo& kernel_;
    const GroupedData& data_;
    double floor_;
    // Scratch, kept from one evaluation to the next: the covariance, its slope, what weighs them in the
    // gradient.
    Eigen::MatrixXd value_, slope_, weights_;
    GaussianProcessSystem system_;
};

}  // namespace loam::surrogate
