// The ensemble that all samples of a data set share: its stages, its specimens, its runs.
//
// Where void ratio is an input, the specimens of the training pool cover the samples' range evenly, and each
// sample's direct runs are made on specimens of its own void ratio.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/bulk/stages.hpp"
#include "experiments/campaign.hpp"

namespace loam::experiments {

/// A sample whose estimate is to be tried by direct runs.
struct DirectTrial {
    std::size_t row = 0;         // of the data set
    Eigen::VectorXd parameters;  // SI, as Campaign's runs want them
};

class SharedEnsemble {
  public:
    /// Throws what Campaign and common_stages() throw.
    SharedEnsemble(const Settings& settings, const lab_data::DataSet& set,
                   const std::filesystem::path& folder, RunLog* log);

    const StageSet& stages() const { return stages_; }
    Campaign& campaign() { return *campaign_; }
    const ParameterSpace& space() const { return campaign_->space(); }
    const std::vector<std::string>& warnings() const { return warnings_; }

    /// Number of the emulator's inputs: the fitted parameters, and the void ratio where it is one.
    Eigen::Index inputs() const { return space().dimension() + (void_ratio_ ? 1 : 0); }
    bool varies_void_ratio() const { return void_ratio_.has_value(); }
    /// Coordinates [inputs()] of a run, by the void ratio that its specimen really has; those of the law's
    /// parameters are in the unit cube, that of the void ratio about so.
    Eigen::VectorXd unit(const RunRecord& run) const;
    /// Parameters of a run for the fitted coordinates x [d], at a sample's void ratio (moved into the range).
    Eigen::VectorXd physical(const Eigen::VectorXd& x, const lab_data::Test& test) const;
    /// Coordinate of the sample's void ratio; 0 where it is no input.
    double void_ratio_coordinate(const lab_data::Test& test) const;

    /// The first training runs: a design over the prior.
    std::vector<RunRecord> train(Eigen::Index count);
    /// Further training runs at points [n x d] of the unit cube; `first` is the number of the first of them.
    std::vector<RunRecord> train_at(const Eigen::MatrixXd& points, std::uint64_t first);
    /// Those further runs, if all `count` of them are stored.
    std::optional<std::vector<RunRecord>> stored_further(std::uint64_t first, Eigen::Index count) const;
    /// `count` direct runs for each trial, on specimens that no emulator saw; [trials][count]. `turn`, 0..9,
    /// tells their specimens from those of earlier trials of the same rows.
    std::vector<std::vector<RunRecord>> confirm(const std::vector<DirectTrial>& trials, int count,
                                                int turn = 0);

  private:
    void choose_void_ratio(const Settings& settings, const lab_data::DataSet& set);
    void make_reference(const lab_data::DataSet& set);
    std::vector<RunRecord> run_stiffest_first(const char* title, const std::vector<RunSpec>& specs);
    RunSpec training_spec(std::uint64_t index, const char* purpose, Eigen::VectorXd parameters) const;

    StageSet stages_;
    std::optional<std::pair<double, double>> void_ratio_;  // range of the training specimens'
    std::vector<std::string> warnings_;
    lab_data::Sample reference_;  // a test through the stages, without measurements
    std::unique_ptr<Campaign> campaign_;
};

}  // namespace loam::experiments
