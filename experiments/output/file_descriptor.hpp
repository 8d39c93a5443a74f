// POSIX files with the guarantees that a result needs: whole or not at all, and on the disk when it is said
// to be. (iostreams can neither sync nor tell a full disk from a closed stream.)
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace loam::experiments {

/// Owns an open file; closes it when it goes out of scope.
class FileDescriptor {
  public:
    FileDescriptor() = default;
    explicit FileDescriptor(int fd) : fd_(fd) {}
    ~FileDescriptor();
    FileDescriptor(FileDescriptor&& other) noexcept;
    FileDescriptor& operator=(FileDescriptor&& other) noexcept;

    explicit operator bool() const { return fd_ >= 0; }
    int get() const { return fd_; }

  private:
    int fd_ = -1;
};

/// open(2), again when a signal interrupts it, not inherited by programs started from here. Empty on failure,
/// with errno set.
FileDescriptor open_file(const std::filesystem::path& path, int flags);

/// Writes all of `content` at the file's position: 0, or errno if only a part (or nothing) was written.
int write_all(int fd, std::string_view content);

/// The whole file, nothing if there is none. Throws lab_data::UserError if it cannot be read.
std::optional<std::string> read_file_if_there(const std::filesystem::path& path);

/// The whole file. Throws lab_data::UserError if it cannot be read.
std::string read_whole_file(const std::filesystem::path& path);

/// Makes creations, renames and removals in `folder` durable. Throws as throw_write_error does.
void sync_folder(const std::filesystem::path& folder);

}  // namespace loam::experiments
