// The blind twins of loam bench diagnose: synthetic soils with an effect of known strength hidden in them, or
// two, or none. They differ from what is fitted in packings, number of particles, grading, rate of loading,
// damping and noise.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "experiments/diagnosis/search.hpp"

namespace loam::experiments {

/// Wanted length of a hidden effect's fingerprint, in noises, after what the parameters absorb.
inline constexpr double weak = 3, medium = 6, strong = 12;

/// What is hidden in a twin.
struct TwinTruth {
    std::string name;
    int soil = 0;
    std::vector<std::string> effects;  // none, one or two
    std::vector<double> strengths;     // SI
    double wanted = 0, reached = 0;    // fingerprint of the first effect, in noises
    bool withheld = false;             // the diagnosis is not told of the effect
};
nlohmann::json to_json(const TwinTruth& truth);

class TwinFactory {
  public:
    /// Keeps its runs in sub-folders of `folder`. `given`: the command line's settings.
    TwinFactory(const Settings& given, std::filesystem::path folder, RunLog& log);

    /// The model that is diagnosed, without any effect.
    const Settings& model() const { return model_; }
    /// The effects that may be hidden: all that the model has not and that show in the tests.
    const std::vector<const ModelEffect*>& effects() const { return effects_; }
    /// A diagnosis in `place` that starts from the training runs that all share: of the model, and of the
    /// model with each effect. Does nothing where the folder is there.
    void prepare(const std::filesystem::path& place) const;

    /// All twins of the benchmark, in an order of which every beginning is a fair sample. Strengths are found
    /// by trial, for each effect and soil; what cannot be made so strong within its prior's bounds is left
    /// out.
    std::vector<TwinTruth> plan();
    /// What a laboratory would measure on each of them. Twins whose own run fails are left out.
    std::vector<lab_data::Sample> measure(std::vector<TwinTruth>& twins);

  private:
    struct Strength {
        double value = 0, reached = 0;
    };
    /// Of each effect (first index), weak, medium and strong.
    std::vector<std::vector<Strength>> find_strengths(int soil);
    std::vector<RunRecord> simulate(const TwinTruth& like, const std::vector<TwinTruth>& twins,
                                    const std::vector<std::size_t>& places);
    lab_data::Sample measured(const RunRecord& run, const std::string& name) const;

    std::filesystem::path folder_;
    RunLog& log_;
    Settings model_, twin_;
    lab_data::Sample tests_;  // without measurements
    Observation form_;        // of the tests, without measurements
    std::vector<Eigen::Index> columns_;
    std::vector<const ModelEffect*> effects_;
    Eigen::MatrixXd soils_;  // [soils x d] coordinates in the unit cube
};

}  // namespace loam::experiments
