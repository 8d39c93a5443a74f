// The effects of the laboratory test in one run: its specimen, the test as that meets it, and what the device
// makes of the outputs.
#pragma once

#include <span>
#include <vector>

#include "experiments/effects/model_effects.hpp"
#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// The settings' effects that are not of the contact, and where their parameters stand among a run's.
class TestEffects {
  public:
    explicit TestEffects(const Settings& settings);

    /// Whether there are any.
    bool empty() const { return applied_.empty(); }

    // `parameters`: of a run (SI), those of the law first, then those of the effects in the settings' order.

    /// Initial void ratio of the specimens above the stated one.
    double void_ratio_error(const Eigen::VectorXd& parameters) const;
    /// The test as the specimen meets it, with the same readings.
    lab_data::Test as_met(const SimulatedTest& test, const Eigen::VectorXd& parameters) const;
    /// Makes the specimen's outputs [channels x n] those of the device.
    void correct(const SimulatedTest& test, const Eigen::VectorXd& parameters,
                 Eigen::VectorXd& outputs) const;

  private:
    struct Applied {
        const ModelEffect* effect;
        std::size_t first;
    };
    static std::span<const double> values_of(const Applied& applied, const Eigen::VectorXd& parameters);

    std::vector<Applied> applied_;
};

}  // namespace loam::experiments
