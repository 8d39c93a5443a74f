// The folder of a run: made, locked against a second process, and tied to its settings, so that the same
// command again continues it and another command cannot spoil it.
#pragma once

#include <filesystem>

#include "experiments/output/file_descriptor.hpp"
#include "experiments/settings/settings.hpp"

namespace loam::experiments {

class RunFolder {
  public:
    /// Makes or reopens settings.out. A new folder gets config.toml; one that holds simulations must have
    /// been made with the same settings. In one where a run was begun but came to no simulation, as its input
    /// was at fault, the run's config.toml gives way to that of other settings; a user's own does not. Throws
    /// UserError if the folder cannot be written, is in use, belongs to other settings, or is one of
    /// something else; StorageError if the disk is full.
    explicit RunFolder(const Settings& settings);

    const std::filesystem::path& path() const { return path_; }
    /// A file of the run: file("result.json").
    std::filesystem::path file(const char* name) const { return path_ / name; }
    /// Whether the folder held a run before.
    bool resumed() const { return resumed_; }

  private:
    std::filesystem::path path_;
    FileDescriptor lock_;  // of the folder, held while this lives
    bool resumed_ = false;
};

/// Throws UserError if a run with these settings would write over `given`, the configuration from which they
/// were read (empty: none).
void spare_configuration(const std::filesystem::path& given, const Settings& settings);

}  // namespace loam::experiments
