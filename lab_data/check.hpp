// Is this sample or data set sound? Collects every fault that can be seen in one go, for `loam check`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lab_data/user_error.hpp"

namespace loam::lab_data {

enum class PathKind { sample, data_set, other_file };

/// What `path` is: a sample's folder or its sample.toml, a data set's folder or its dataset.toml, or another
/// regular file (say, a configuration). Throws UserError if there is nothing of the kind.
PathKind kind_of(const std::filesystem::path& path);

struct CheckReport {
    PathKind kind = PathKind::sample;
    std::string name;  // of the sample or data set, if it could be read
    std::vector<std::string>
        contents;  // one line a test: kind, file, number of readings; a data set: one line in all
    std::vector<UserError> errors;      // in the order of the files and their lines
    std::vector<std::string> warnings;  // odd but usable

    bool sound() const { return errors.empty(); }
};

/// Checks the sample or data set at `path`. Faults of its files are in the report.
/// Throws UserError only if kind_of() does, or if `path` is another file.
CheckReport check(const std::filesystem::path& path);

}  // namespace loam::lab_data
