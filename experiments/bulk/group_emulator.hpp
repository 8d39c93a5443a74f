// Emulators that many samples share: one for each scale of strain and each number of stages that is needed,
// with a library of points spread over the prior, whose predictions every sample's search starts from.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "experiments/bulk/shared_ensemble.hpp"
#include "experiments/fit.hpp"
#include "surrogate/curve_emulator.hpp"

namespace loam::experiments {

/// One sample's measured loading curve as the emulators see it.
struct BulkSample {
    std::size_t row = 0;  // of the data set
    const lab_data::Test* test = nullptr;
    LoadingCurve curve;
    Observation observation;
    Eigen::MatrixXd interpolation;  // [m x n] from the first n stages
    OutputTransform transform;
    double void_ratio = 0;    // coordinate; unused where it is no input
    Eigen::Index needed = 0;  // of the stages, from the first: a run must have reached them

    Eigen::Index stages() const { return interpolation.cols(); }
};

/// The samples that can be fitted: readable, with at least two loading stages; `left_out` gets the others
/// with the reason, but for those that could not be read.
std::vector<BulkSample> bulk_samples(const SharedEnsemble& ensemble, const lab_data::DataSet& set,
                                     const Settings& settings,
                                     std::vector<std::pair<std::size_t, std::string>>& left_out);

struct GroupEmulator {
    surrogate::CurveEmulator emulator;  // of T(strain) at the first stages
    OutputTransform transform;
    Eigen::Index stages = 0;
    Eigen::Index runs = 0;
    Eigen::MatrixXd library;                         // [d + 1 x k] fitted coordinates, then misfit's
    Eigen::VectorXd library_void_ratio;              // [k] coordinate
    Eigen::MatrixXd library_mean, library_variance;  // [k x q] of the components
    Eigen::VectorXd typical_variance;                // [q] CurveEmulator's

    std::string description() const;  // a sentence
};

class GroupEmulators {
  public:
    /// Trains what the samples need, with so many points in each library. Throws std::runtime_error when too
    /// few runs succeeded.
    GroupEmulators(const SharedEnsemble& ensemble, const std::vector<RunRecord>& runs,
                   const std::vector<BulkSample>& samples, const Settings& settings,
                   Eigen::Index points = 8192);

    const GroupEmulator& of(const BulkSample& sample) const;
    const std::vector<GroupEmulator>& all() const { return groups_; }

  private:
    std::vector<GroupEmulator> groups_;
};

}  // namespace loam::experiments
