// How long the parts of a study take.
#pragma once

#include <chrono>
#include <string>
#include <utility>

#include "experiments/bulk/study.hpp"

namespace loam::experiments {

/// Adds the seconds of a stretch of work to the study's part of that name.
class PartTimer {
  public:
    PartTimer(BulkStudy& study, std::string name)
        : study_(study), name_(std::move(name)), began_(std::chrono::steady_clock::now()) {}
    ~PartTimer() {
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
        for (Part& part : study_.parts)
            if (part.name == name_) {
                part.seconds += seconds;
                return;
            }
        study_.parts.push_back({name_, seconds});
    }
    PartTimer(const PartTimer&) = delete;
    PartTimer& operator=(const PartTimer&) = delete;

  private:
    BulkStudy& study_;
    std::string name_;
    std::chrono::steady_clock::time_point began_;
};

}  // namespace loam::experiments
