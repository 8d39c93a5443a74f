// Reads a text file whole, after making sure that it is one and of a bearable size.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "lab_data/faults.hpp"

namespace loam::lab_data {

/// A remedy for a path that does not exist: the nearest name beside it.
std::string missing_file_remedy(const std::filesystem::path& path);

/// Whether `file`, a name written in a file that `where` points at, is a file inside its folder: relative,
/// without "..", without control characters, there, and no folder itself. Reports a fault and gives false if
/// not.
bool is_in_folder(const std::filesystem::path& folder, const std::string& file, const Fault& where,
                  Faults& faults);

/// The file's text in UTF-8, without byte order mark. Reports a fault and gives nothing if it does not exist,
/// is no regular file, cannot be read, is larger than `largest` bytes, or is no UTF-8 text (with the line).
std::optional<std::string> read_text(const std::filesystem::path& path, std::size_t largest, Faults& faults);

}  // namespace loam::lab_data
