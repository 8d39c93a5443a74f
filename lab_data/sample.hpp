// A soil sample as measured: what is known of the soil, and one curve a laboratory test.
// A sample is a folder with sample.toml and one CSV file a test; lab_data/sets/README.md describes the
// format. Everything is in SI (Pa, m, rad, kg/m3, ratios); compression, settlement and shear in the first
// direction are positive.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lab_data/user_error.hpp"

namespace loam::lab_data {

enum class TestKind { oedometer, triaxial, direct_shear };

/// The name of a kind as files write it: "oedometer", "triaxial", "direct_shear".
std::string_view to_string(TestKind kind);

/// One laboratory test. Settings that its kind does not have stay at their defaults.
struct Test {
    TestKind kind = TestKind::oedometer;
    std::string file;                          // as written, relative to the folder
    std::optional<double> initial_void_ratio;  // 1
    std::optional<double>
        seating_stress;              // Pa; oedometer: where strain is zero, if stated (see seating_stress())
    double cell_pressure = 0;        // Pa; triaxial, > 0
    double normal_stress = 0;        // Pa; direct shear, > 0
    double box_length = 0;           // m; direct shear, > 0
    double box_width = 0;            // m; direct shear, > 0 (the length unless stated)
    double box_height = 0;           // m; direct shear, > 0, at the start of shearing
    double wall_friction_angle = 0;  // rad; direct shear
    std::map<std::string, double> measurement_sd;  // SI, by channel; empty: not stated

    /// Readings in SI by quantity, all of size(); names without unit. Always there:
    /// oedometer axial_stress, axial_strain; triaxial axial_strain, deviatoric_stress, volumetric_strain;
    /// direct shear shear_displacement, shear_stress, settlement (a shear_strain or settlement_strain in the
    /// file is converted). If the file has them: oedometer lateral_stress, void_ratio; direct shear
    /// normal_stress.
    std::map<std::string, std::vector<double>> columns;
    /// Columns of the file that mean nothing here, as text, by their full name in the file.
    std::map<std::string, std::vector<std::string>> other_columns;
    std::vector<std::string>
        phase;               // oedometer: loading | unloading | reloading a reading; empty: all loading
    std::vector<int> lines;  // line of each reading in the file, from 1

    std::size_t size() const { return lines.size(); }
    /// A column that is known to be there; throws std::out_of_range if it is not.
    const std::vector<double>& column(const std::string& quantity) const { return columns.at(quantity); }
};

/// The stress (Pa) at which an oedometer test's strain counts as zero: as stated; else the first stage's
/// stress if its strain is zero; else 2 kPa, a usual seating load, or half the first stage's stress where
/// that is less.
double seating_stress(const Test& test);

struct GradingPoint {
    double sieve = 0;    // m
    double passing = 0;  // ratio by mass, 0..1
};

using Property = std::variant<double, std::string>;

struct Sample {
    std::string name;
    std::string description;
    std::string source;
    std::string licence;
    std::string notes;
    std::string attribution;
    bool measured = true;               // false: synthetic
    double grain_density = 0;           // kg/m3
    std::vector<GradingPoint> grading;  // by rising sieve; empty: not stated
    std::map<std::string, Property> properties;
    std::vector<Test> tests;  // in the file's order, at least one
    std::filesystem::path folder;
    std::vector<std::string> warnings;  // what is odd but usable, one sentence each with its place
};

/// Reads the sample in folder `path` (or whose sample.toml is `path`).
/// Throws UserError with the first fault found, having read everything; check() gives all of them.
Sample read_sample(const std::filesystem::path& path);

}  // namespace loam::lab_data
