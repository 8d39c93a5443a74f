// Writing a result so that it is never half there: whoever opens the file finds the old content or the new
// one, whatever kills the process or the machine in between.
#pragma once

#include <filesystem>
#include <string_view>

namespace loam::experiments {

/// Writes `content` to `path` + ".tmp", syncs it, renames it to `path` and syncs the folder. On failure the
/// temporary is removed and the old file is untouched. Throws lab_data::UserError (no such folder, not
/// writable) or StorageError (disk full). One writer a file: concurrent writers need a lock of their own.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Makes `folder` with its parents and checks that files can be made in it. Throws lab_data::UserError or
/// StorageError.
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace loam::experiments
