// What a laboratory could do next to settle which of several effects is missing.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "experiments/effects/model_effects.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// What has been measured.
struct MeasuredTests {
    std::set<lab_data::TestKind> kinds;
    std::vector<double> pressures;  // Pa, of triaxial and direct shear tests
    bool has_unloading = false;     // of an oedometer
};
MeasuredTests measured_tests(std::span<const lab_data::Test> tests);

/// A sentence: the measurement by which the first of `effects` that has one of its own is told from all
/// others, else the kind of test that is still missing. `effects` may be empty.
std::string next_test(const std::vector<std::string>& effects, const MeasuredTests& measured);

}  // namespace loam::experiments
