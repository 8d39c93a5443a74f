// One process at a time works in a run folder.
#pragma once

#include <filesystem>

#include "experiments/output/file_descriptor.hpp"

namespace loam::experiments {

/// Holds the lock of a folder (flock on its file ".lock") while it lives. The system releases it however the
/// process ends, so that a killed one leaves nothing to clean up.
class FolderLock {
  public:
    /// Throws lab_data::UserError if another process (or another FolderLock of this one) holds it, or if the
    /// folder cannot be written.
    explicit FolderLock(const std::filesystem::path& folder);

  private:
    FileDescriptor file_;
};

}  // namespace loam::experiments
