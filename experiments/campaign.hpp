// A campaign: virtual tests of one sample, run for many parameter sets and packings, kept in the run folder's
// store.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "experiments/effects/run_effects.hpp"
#include "experiments/ensemble/ensemble.hpp"
#include "experiments/lab_tests/registry.hpp"
#include "experiments/output/log.hpp"
#include "experiments/parameter_space.hpp"
#include "experiments/specimens.hpp"
#include "experiments/store/ensemble_store.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// A measured test that is simulated, and where its numbers stand among a run's outputs.
struct CampaignTest {
    const lab_data::Test* test;
    const LabTestKind* kind;
    std::vector<std::size_t> readings;  // [n] of the measurement
    Eigen::Index first = 0;             // of its outputs, n for each channel of its kind, in their order
    bool held_out = false;
    double porosity = 0;  // at which its specimen is made

    Eigen::Index outputs() const {
        return static_cast<Eigen::Index>(readings.size() * kind->channels.size());
    }
    /// The output of a channel at the first of the readings used.
    Eigen::Index first_of(std::size_t channel) const {
        return first + static_cast<Eigen::Index>(channel * readings.size());
    }
    /// A column of the measurement at the readings used [n], SI.
    Eigen::VectorXd measured(std::string_view column) const;
};

/// One channel of a campaign's test: outputs first .. first + n - 1.
struct CampaignCurve {
    const CampaignTest* test;
    const TestChannel* channel;
    Eigen::Index first;

    Eigen::Index count() const { return static_cast<Eigen::Index>(test->readings.size()); }
    Eigen::VectorXd measured() const { return test->measured(channel->name); }
};

/// Diagnostics of every run, in the order in which the store keeps them.
enum Diagnostic : Eigen::Index {
    inertial_number,
    unbalanced_ratio,
    servo_error,
    overlap,
    energy_error,
    steps,
    porosity,
    diagnostic_count
};

struct CampaignOptions {
    /// Bounds of the specimens' initial void ratio where it differs from run to run: it is then a run's last
    /// parameter, after the law's. Empty: specimens are made as each test says.
    std::optional<std::pair<double, double>> void_ratio{};
    /// A run that ends early (too large a strain, say) is kept with the stages it reached: their number is a
    /// further output, the last, and the outputs not reached hold the number before them.
    bool keep_partial = false;
};

/// Whether a campaign could simulate the sample's tests: warns of densities far apart, and throws UserError
/// where a test cannot be simulated.
std::vector<std::string> check_tests(const Settings& settings, const lab_data::Sample& sample);

class Campaign {
  public:
    /// `folder` holds the store; `log` may be null. The sample must outlive the campaign. Throws UserError
    /// where no test of the sample can be simulated, and what the store throws.
    Campaign(const Settings& settings, const lab_data::Sample& sample, const std::filesystem::path& folder,
             RunLog* log, const CampaignOptions& options = {});

    const Settings& settings() const { return settings_; }
    const ParameterSpace& space() const { return space_; }
    const std::vector<CampaignTest>& tests() const { return tests_; }
    /// All channels of all tests, in the order of the outputs.
    std::vector<CampaignCurve> curves() const;
    const EnsembleStore& store() const { return store_; }
    Eigen::Index output_count() const { return outputs_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

    /// Makes the runs that are missing, with a progress bar under that title. Records in the order of the
    /// specs.
    std::vector<RunRecord> run(std::string_view title, std::span<const RunSpec> specs);

    /// What a test of that run is made on: a packing of its own, or the one that the settings name.
    std::shared_ptr<const Specimen> specimen(const CampaignTest& test, const RunSpec& spec);
    double grain_density() const { return grain_density_; }
    /// Whether the sample is a real soil, whose grains are countless, or synthetic.
    bool measured() const { return measured_; }

  private:
    RunRecord simulate(const RunSpec& spec, const StopToken& stop);
    double porosity_of(const CampaignTest& test, const RunSpec& spec) const;
    std::shared_ptr<const Specimen> specimen_of(const CampaignTest& test, const RunSpec& spec,
                                                const StopToken& stop);

    Settings settings_;
    const lab_data::Sample* sample_;
    CampaignOptions options_;
    ParameterSpace space_;
    TestEffects effects_;
    std::vector<std::string> warnings_;  // before the tests, whose selection adds to it
    std::vector<CampaignTest> tests_;
    std::vector<std::size_t> as_simulated_;  // of tests_: a run ends with the first that fails
    Eigen::Index outputs_ = 0;
    double grain_density_ = 0;
    bool measured_ = true;
    std::shared_ptr<const Specimen> given_;  // by the settings
    EnsembleStore store_;
    RunLog* log_;
};

/// Runs that failed among the records.
std::size_t failed_count(const EnsembleStore& store);

}  // namespace loam::experiments
