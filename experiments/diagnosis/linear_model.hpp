// A calibrated model as the diagnosis sees it: linear in its parameters about the estimate, with normal noise
// and normal priors. What the parameters can absorb is projected out by generalised least squares with the
// priors.
//
//   measured - model = r = J (theta - mean) + noise,  theta ~ N(mean, P),  noise ~ N(0, S)
//
// so that r ~ N(0, V) with V = S + J P J'. What is left after the fit is S V^-1 r, of covariance S V^-1 S,
// and a' V^-1 b is the inner product of two curves after projection: V^-1 is, by Woodbury, S^-1 - S^-1 J
// (P^-1 + J' S^-1 J)^-1 J' S^-1. Source: Kennedy and O'Hagan 2001; Brynjarsdottir and O'Hagan 2014.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace loam::experiments {

struct LinearModel {
    Eigen::VectorXd residual;  // [m] measured minus model at the priors' mean
    Eigen::MatrixXd jacobian;  // [m x d] of the model
    Eigen::MatrixXd noise;     // S [m x m], positive definite
    Eigen::VectorXd prior_sd;  // [d] of the parameters; P is diagonal
};

class Projection {
  public:
    /// Throws std::invalid_argument where sizes do not fit or V is not positive definite.
    explicit Projection(const LinearModel& model);

    Eigen::Index size() const { return model_.residual.size(); }
    const LinearModel& model() const { return model_; }
    /// What the fit leaves of a curve [m]: S V^-1 a.
    Eigen::VectorXd projected(const Eigen::VectorXd& curve) const;
    /// a' V^-1 b.
    double inner(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
    /// Length of a curve after projection, in units of the noise: sqrt(a' V^-1 a).
    double norm(const Eigen::VectorXd& a) const;
    /// V^-1 a [m].
    Eigen::VectorXd weights(const Eigen::VectorXd& curve) const;
    /// log N(residual; 0, V).
    double log_evidence() const;
    /// Weights [m] on a residual that give `weights` on what the fit leaves of it: V^-1 S w.
    Eigen::VectorXd projected_weights(const Eigen::VectorXd& weights) const;
    /// Covariance [k x k] of the rows' [k x m] sums of a residual: rows V rows'.
    Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& rows) const;
    /// A residual [m] drawn from N(0, V) out of m independent standard normals [m].
    Eigen::VectorXd draw(const Eigen::VectorXd& normals) const;

  private:
    LinearModel model_;
    Eigen::LLT<Eigen::MatrixXd> marginal_;  // of V
};

}  // namespace loam::experiments
