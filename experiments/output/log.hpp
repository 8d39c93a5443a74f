// The run folder's log.txt: what was done when, in plain lines, appended to by every session that works in
// the folder.
#pragma once

#include <filesystem>
#include <mutex>
#include <string_view>

#include "experiments/output/file_descriptor.hpp"

namespace loam::experiments {

class RunLog {
  public:
    /// Opens `path` to append. Throws lab_data::UserError or StorageError if that cannot be done.
    explicit RunLog(const std::filesystem::path& path);

    /// One line "2024-05-01T12:00:00Z text" in UTC; further lines of the text are indented below it. Any
    /// thread. Never throws for a disk that has filled up: the log is no reason to stop, and the files that
    /// hold results report it.
    void write(std::string_view text);

  private:
    std::mutex mutex_;
    FileDescriptor file_;
};

}  // namespace loam::experiments
