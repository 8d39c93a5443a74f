// The kinds of laboratory test that can be run virtually. To add one: experiments/lab_tests/<name>.cpp and
// one line of the table in registry.cpp.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/packing.hpp"
#include "engine/simulation.hpp"
#include "experiments/settings/settings.hpp"
#include "experiments/store/header.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// What one virtual test gave, and how quasi-static it was.
struct VirtualTestResult {
    bool ok = false;
    std::string reason;           // why not
    bool stopped_early = false;   // after some stages: their outputs are there, the others NaN
    Eigen::VectorXd outputs;      // [readings used], SI
    double inertial_number = 0;   // largest
    double unbalanced_ratio = 0;  // mean during loading
    double servo_error = 0;       // largest relative error of the seating stress
    double overlap = 0;           // largest over R_i + R_j
    double energy_error = 0;      // of the energy balance
    double steps = 0;
    double seated_porosity = 0;
};

/// The packing under load, for pictures.
struct PictureOfTest {
    engine::Packing packing;
    std::vector<engine::ContactView> contacts;
    double stress = 0;  // axial (Pa)
};

struct LabTestKind {
    lab_data::TestKind kind;
    std::string_view meaning;
    /// The readings of the measurement that are simulated, as indices into its columns (all of them, or a
    /// selection where a test has hundreds).
    std::vector<std::size_t> (*readings)(const lab_data::Test&);
    /// One column for each of those readings.
    std::vector<OutputColumn> (*outputs)(const lab_data::Test&);
    /// Runs the test on the packing; throws what the engine throws, and std::runtime_error when cancelled.
    VirtualTestResult (*run)(const engine::Packing&, const engine::ContactLaw&, const Settings&,
                             double grain_density, const lab_data::Test&,
                             const std::function<bool()>& cancelled);
    /// The packing under the highest stress of the test.
    PictureOfTest (*picture)(const engine::Packing&, const engine::ContactLaw&, const Settings&,
                             double grain_density, const lab_data::Test&);
};

std::span<const LabTestKind> lab_test_kinds();

/// The kind's entry, or nullptr where it cannot be simulated.
const LabTestKind* find_lab_test(lab_data::TestKind kind);

}  // namespace loam::experiments
