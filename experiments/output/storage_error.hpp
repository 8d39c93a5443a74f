// What to say when the file system refuses: one place decides whether it is the user's mistake (a folder that
// cannot be written) or the machine's trouble (a full disk), and words the remedy.
#pragma once

#include <filesystem>
#include <stdexcept>

namespace loam::experiments {

/// The disk is full, over quota or broken. The program ran but failed (exit status 1): the same command again
/// continues once there is room.
class StorageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Throws lab_data::UserError where another place would do (no such folder, something else there, no
/// permission, read-only), and StorageError otherwise. `error` is the value of errno left by an attempt to
/// write `path`.
[[noreturn]] void throw_write_error(const std::filesystem::path& path, int error);

/// Throws lab_data::UserError: `path` could not be read, `error` is the value of errno.
[[noreturn]] void throw_read_error(const std::filesystem::path& path, int error);

}  // namespace loam::experiments
