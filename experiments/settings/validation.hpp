// The one place where settings are checked, whoever filled them in.
#pragma once

#include <algorithm>

#include "experiments/settings/reading.hpp"

namespace loam::experiments {

/// Where the setting of that path was stated; if it was not, an origin with only its path as the name.
Origin origin_of(const Origins& origins, std::string_view path);

/// The fewest finished runs from which an emulator of so many parameters can be trained.
constexpr int fewest_training_runs(int parameters) {
    return std::max(5 * parameters, 20);
}

/// Throws UserError (field, value, constraint, remedy) for the first setting that cannot be used.
void validate(const Settings& settings, const Origins& origins = {});

}  // namespace loam::experiments
