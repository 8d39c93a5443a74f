// Settings as the text of a configuration file.
#pragma once

#include <string>
#include <string_view>

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// What a configuration written here begins with; one that does not is the user's own.
inline constexpr std::string_view first_words = "# Every setting of this run.";

/// Every effective setting with its meaning as a comment. Reading it back gives the same settings.
std::string to_toml(const Settings& settings);

/// The path of the first setting ("engine.damping") in which a run that is to be resumed differs from the
/// stored one; empty if there is none. Settings that do not change a result (jobs, quiet, json, where files
/// lie) do not count.
std::string first_difference(const Settings& stored, const Settings& now);

/// One setting's value as to_toml() writes it; `path` as first_difference() gives it. Empty if it is not set.
std::string value_text(const Settings& settings, const std::string& path);

}  // namespace loam::experiments
