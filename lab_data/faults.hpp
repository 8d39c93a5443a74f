// Collects what is wrong with the files being read, so that one reading reports all of it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lab_data/user_error.hpp"

namespace loam::lab_data {

/// A column of a thousand bad cells is one mistake: the first few are reported, the rest counted.
constexpr int shown_faults_per_column = 3;

struct Faults {
    std::vector<UserError> errors;
    std::vector<std::string> warnings;

    void error(Fault fault) { errors.emplace_back(std::move(fault)); }
    void warn(const std::string& place, const std::string& text) { warnings.push_back(place + ": " + text); }
};

/// Reports faults of one column or of one kind, up to shown_faults_per_column, and says at its end how many
/// more there were.
class RepeatedFault {
  public:
    RepeatedFault(Faults& faults, std::string place) : faults_(faults), place_(std::move(place)) {}
    RepeatedFault(const RepeatedFault&) = delete;
    RepeatedFault& operator=(const RepeatedFault&) = delete;
    ~RepeatedFault() {
        if (count_ > shown_faults_per_column)
            faults_.warn(place_,
                         std::to_string(count_ - shown_faults_per_column) + " more errors of the same kind");
    }

    void error(Fault fault) {
        if (++count_ <= shown_faults_per_column) faults_.error(std::move(fault));
    }
    int count() const { return count_; }

  private:
    Faults& faults_;
    std::string place_;
    int count_ = 0;
};

}  // namespace loam::lab_data
