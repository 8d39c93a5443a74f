// The kinds of laboratory test that can be run virtually. To add one: experiments/lab_tests/<name>.cpp and
// one line of the table in registry.cpp.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/boxed_packing.hpp"
#include "engine/simulation.hpp"
#include "experiments/settings/settings.hpp"
#include "experiments/store/header.hpp"
#include "lab_data/sample.hpp"

namespace loam::experiments {

/// How a specimen is made: in a periodic cell, or between the walls of a box with sides in these proportions.
struct SpecimenShape {
    std::uint32_t particles = 0;
    std::optional<Eigen::Vector3d> proportions{};
    friend bool operator==(const SpecimenShape&, const SpecimenShape&) = default;
};

/// What a virtual test is made on.
struct Specimen {
    engine::Packing packing;
    std::optional<engine::Box> box{};  // between whose walls it lies; empty: in its periodic cell
    double porosity = 0;               // of the cell or box
    bool reached = true;               // the porosity that was asked for
    std::string stopped_by{};          // why not
};

/// What one virtual test gave, and how quasi-static it was.
struct VirtualTestResult {
    bool ok = false;
    std::string reason;           // why not
    bool stopped_early = false;   // after some stages: their outputs are there, the others NaN
    Eigen::VectorXd outputs;      // [channels x readings used], SI, channel after channel
    double inertial_number = 0;   // largest
    double unbalanced_ratio = 0;  // mean during loading
    double servo_error = 0;       // relative, of the stress that is held
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

/// A measured quantity that a kind of test gives along its curve.
struct TestChannel {
    std::string_view name;  // column of lab_data::Test
    std::string_view unit;  // as results say it: "Pa", "m/m", "m"
};

struct LabTestKind {
    lab_data::TestKind kind;
    std::string_view meaning;
    std::string_view x_name, x_unit;  // what the curves are drawn over
    bool x_logarithmic;
    std::span<const TestChannel> channels;
    /// The readings of the measurement that are simulated, as indices into its columns (all of them, or a
    /// selection where a test has hundreds).
    std::vector<std::size_t> (*readings)(const lab_data::Test&);
    /// How the test's specimen is made at that porosity, where the settings ask for so many particles.
    SpecimenShape (*shape)(const Settings&, const lab_data::Sample&, const lab_data::Test&, double porosity,
                           std::uint32_t particles);
    /// Runs the test on the specimen; throws what the engine throws, and std::runtime_error when cancelled.
    VirtualTestResult (*run)(const Specimen&, const engine::ContactLaw&, const Settings&,
                             double grain_density, const lab_data::Test&,
                             const std::function<bool()>& cancelled);
    /// The packing under the highest stress of the test, or at its end.
    PictureOfTest (*picture)(const Specimen&, const engine::ContactLaw&, const Settings&,
                             double grain_density, const lab_data::Test&);
};

std::span<const LabTestKind> lab_test_kinds();

/// The columns of a test's outputs in an ensemble: channel after channel, a column for each reading used.
std::vector<OutputColumn> output_columns(const LabTestKind& kind, const lab_data::Test& test);

/// The kind's entry.
const LabTestKind& lab_test(lab_data::TestKind kind);

}  // namespace loam::experiments
