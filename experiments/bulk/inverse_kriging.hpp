// The method of De Pue et al. 2019: every parameter is predicted straight from the measured strains by
// ordinary kriging of the training ensemble, one semivariogram for each parameter and stage.
//
// The paper fits a Gaussian semivariogram of each parameter over each stage's strain; it does not say how the
// eight become one. Here h^2 is the mean over the stages of (difference / range)^2: the stages strain
// together, and each one's semivariogram, taken alone, already holds what the others do. Nugget and sill are
// those of the stage that leaves least unexplained. Ordinary kriging is a Gaussian process with an unknown
// constant mean, and is computed as one.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "experiments/bulk/study.hpp"
#include "surrogate/gaussian_process.hpp"
#include "surrogate/statistics/semivariogram.hpp"

namespace loam::experiments {

/// One parameter over the strain at one stage.
struct StageSemivariogram {
    double stress = 0;  // Pa
    surrogate::ExperimentalSemivariogram experimental;
    surrogate::GaussianSemivariogram model;
};

class InverseKriging {
  public:
    InverseKriging(const SharedEnsemble& ensemble, const std::vector<RunRecord>& runs);

    /// Any thread. Throws std::runtime_error where too few runs reached the sample's stages.
    FittedSample fit(const BulkSample& sample);

    /// [d][stages] of the parameters in the unit cube over the strains at these stresses.
    std::vector<std::vector<StageSemivariogram>> semivariograms(const BulkSample& sample) const;

  private:
    struct Model {
        std::vector<surrogate::GaussianProcess> processes;  // [d]
    };
    std::shared_ptr<const Model> model_of(const BulkSample& sample);
    void predictors(const BulkSample& sample, Eigen::MatrixXd& strain, Eigen::MatrixXd& parameters) const;

    const SharedEnsemble& ensemble_;
    const std::vector<RunRecord>& runs_;
    std::mutex mutex_;
    std::map<std::vector<double>, std::shared_ptr<const Model>> models_;  // by the sample's stresses
};

}  // namespace loam::experiments
