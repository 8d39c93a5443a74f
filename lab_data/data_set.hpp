// A data set: many samples with one test of the same kind each, and what else is known of them (covariates).
// It is a folder with dataset.toml, samples.csv (one row a sample) and the curves.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "lab_data/sample.hpp"

namespace loam::lab_data {

/// A covariate of a sample: missing, a number (in the unit that its name says, not converted), or a label.
using Covariate = std::variant<std::monostate, double, std::string>;

struct DataSetRow {
    std::string name;                         // of the sample
    std::string file;                         // of its curve, as written
    int line = 0;                             // in samples.csv
    std::vector<Covariate> covariates;        // one for each of DataSet::covariates
    std::variant<Test, UserError> test;       // the curve, or why it cannot be used
    std::vector<UserError> more_faults = {};  // beside that

    bool readable() const { return std::holds_alternative<Test>(test); }
};

struct DataSet {
    std::string name;
    std::string description;
    std::string source;
    std::string licence;
    std::string notes;
    std::string attribution;
    bool measured = true;
    TestKind kind = TestKind::oedometer;
    std::vector<std::string>
        covariates;                // full column names of samples.csv but for sample and file, in its order
    std::vector<DataSetRow> rows;  // in the file's order, at least one
    std::filesystem::path folder;
    std::vector<std::string> warnings;
};

/// Reads the data set in folder `path` (or whose dataset.toml is `path`). A sample whose row or curve is at
/// fault is returned with its reason. Throws UserError for faults of dataset.toml and of the structure of
/// samples.csv. Settings of a test (initial_void_ratio, cell_pressure_kPa, ...) are columns of samples.csv by
/// the names they have in sample.toml; an empty cell leaves them out.
DataSet read_data_set(const std::filesystem::path& path);

}  // namespace loam::lab_data
