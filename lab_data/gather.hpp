// Reading with all faults collected: what read_sample(), read_data_set() and check() share.
#pragma once

#include <filesystem>
#include <optional>

#include "lab_data/data_set.hpp"
#include "lab_data/faults.hpp"
#include "lab_data/sample.hpp"
#include "lab_data/toml_table.hpp"

namespace loam::lab_data {

constexpr std::string_view sample_file = "sample.toml";
constexpr std::string_view data_set_file = "dataset.toml";

/// `path` if its name is `name`, else `name` in folder `path`. Reports a path that is neither, and one
/// that is a data set where a sample is wanted or the reverse.
std::optional<std::filesystem::path> locate(const std::filesystem::path& path, std::string_view name,
                                            Faults& faults);

/// A sample; complete only if `faults` has no errors.
Sample gather_sample(const std::filesystem::path& path, Faults& faults);

/// Likewise a data set. Faults of single samples are in its rows, and not in `faults`.
DataSet gather_data_set(const std::filesystem::path& path, Faults& faults);

/// The keys that samples and data sets share: who made it, where it is from, how it may be used.
template <class T>
void read_identity(const TomlTable& root, T& of, Faults& faults);

}  // namespace loam::lab_data
