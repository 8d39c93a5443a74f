// A bulk study: every sample of a data set fitted through shared emulators, and its estimate tried by direct
// runs on fresh specimens. Finished fits are kept in the run folder, one line each, and are not made again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/bulk/sample_fit.hpp"
#include "experiments/output/log.hpp"

namespace loam::experiments {

/// What is kept of a sample's fit.
struct FittedSample {
    std::size_t row = 0;        // of the data set
    Eigen::VectorXd estimate;   // [d] coordinates in the unit cube
    Eigen::MatrixXd quantiles;  // [d x 3] 5, 50 and 95 % of the posterior
    double misfit = 0, effective = 0, emulator_share = 0;
    Eigen::VectorXd predicted;  // [m] the method's own curve at the sample's stages, SI; may be empty
};

/// Direct runs at a sample's estimate, at the stages of its loading curve.
struct DirectRuns {
    std::vector<Eigen::VectorXd> curves;  // [runs that reached the stages] each [m], SI
    Eigen::VectorXd mean, sd;             // [m]; sd empty for one run
    std::size_t asked = 0;
    std::string reason;  // of the first run that failed
    std::vector<RunRecord> runs{};
};

struct SampleOutcome {
    std::size_t row = 0;
    std::string status;            // calibrated | failed | unreadable
    std::optional<bool> followed;  // whether direct runs at the estimate follow the curve; empty: none made
    std::string reason;            // why not calibrated, or why not followed
    std::optional<BulkSample> sample;
    std::optional<FittedSample> fit;
    std::optional<DirectRuns> direct;
    double rmse = 0, mean_error = 0;  // of the direct runs' mean, m/m; where there are any
};

/// Errors of simulated strains against measured ones, pooled.
struct PooledError {
    double rmse = 0, mean_error = 0, pearson_r = 0;
    std::size_t readings = 0;
};

struct CurvePair {
    Eigen::VectorXd measured, simulated;  // [m] strain
};

/// Both methods on the same samples, by the emulators' curves at their estimates.
struct MethodComparison {
    std::size_t samples = 0;
    PooledError emulator, inverse_kriging;
};

struct Part {
    std::string name;
    double seconds = 0;
};

struct BulkStudy {
    std::vector<SampleOutcome> samples;  // one a row of the data set
    PooledError overall;                 // of all samples with direct runs
    std::vector<RunRecord> training;
    std::vector<std::string> emulators;  // a sentence each
    std::vector<std::string> warnings;
    std::vector<Part> parts;                     // where the time went
    std::optional<MethodComparison> comparison;  // with the method "emulator"
    std::size_t mended = 0;  // fits made again because direct runs showed that the emulator was wrong there
};

/// Runs the study. Throws Interrupted, and what the ensemble and the emulators throw.
BulkStudy run_study(SharedEnsemble& ensemble, const lab_data::DataSet& set, const Settings& settings,
                    const std::filesystem::path& folder, RunLog& log);

PooledError pooled_error(const std::vector<CurvePair>& curves);

}  // namespace loam::experiments
