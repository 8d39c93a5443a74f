// Reads the curve of one laboratory test from its CSV file and checks that it can be one.
#pragma once

#include <filesystem>

#include "lab_data/faults.hpp"
#include "lab_data/sample.hpp"

namespace loam::lab_data {

/// Fills columns, other_columns, phase and lines of `test`, whose kind and settings are set, from file
/// `path`. After a fault the test is not to be used.
void read_curve(const std::filesystem::path& path, Test& test, Faults& faults);

/// Reads a grading curve: columns sieve_mm (or _m) and passing_percent (or a ratio), by rising or falling
/// sieve.
std::vector<GradingPoint> read_grading(const std::filesystem::path& path, Faults& faults);

}  // namespace loam::lab_data
