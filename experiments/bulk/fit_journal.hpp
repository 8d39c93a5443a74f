// The fits that are finished, in the run folder: one line of JSON each, on the disk before the next begins.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>

#include "experiments/bulk/study.hpp"
#include "experiments/output/file_descriptor.hpp"

namespace loam::experiments {

class FitJournal {
  public:
    /// Reads what is there; a last line torn by a kill is cut off. Throws UserError or StorageError.
    explicit FitJournal(const std::filesystem::path& path);

    const std::map<std::size_t, FittedSample>& found() const { return found_; }
    /// Any thread; on the disk when it returns.
    void append(const FittedSample& fit);

  private:
    std::filesystem::path path_;
    std::map<std::size_t, FittedSample> found_;  // by row
    std::mutex mutex_;
    FileDescriptor file_;
};

}  // namespace loam::experiments
