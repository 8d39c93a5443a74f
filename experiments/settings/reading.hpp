// How Settings come to be: defaults, then the configuration file, then the command line; then what follows
// from them (priors of the law, the run folder's name) is filled in, and everything is checked once.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// A setting as the command line gives it. `name` is a key of the top level ("particles"); "set" takes
/// NAME=VALUE.
struct Override {
    std::string name;
    std::string text;
};

/// Where a setting was stated, for the message if it is at fault. Line 0: on the command line.
struct Origin {
    std::string file = {};
    int line = 0;
    int position = 0;
    std::string name = {};  // key in the file, or option
};

/// By the setting's path ("engine.damping", "set.young_modulus", "priors.young_modulus.mean").
using Origins = std::map<std::string, Origin, std::less<>>;

/// What a configuration says of a prior; what it leaves out is the law's default.
struct PriorText {
    std::optional<std::string> kind;
    std::map<std::string, double> numbers;  // mean, sd, lower, upper
};

/// Settings on their way: merged, but neither completed nor checked.
struct Draft {
    Settings settings;
    std::map<std::string, PriorText> priors;
    Origins origins;
};

/// Adds what the TOML text states to the draft. `file` is its path, for messages; relative paths in it are
/// relative to its folder. Throws UserError (file, line, position) for a syntax error, an unknown key, or a
/// value of the wrong type.
void read_toml(Draft& draft, std::string_view text, const std::filesystem::path& file);

/// Adds one option. Relative paths are relative to the working directory. Throws UserError.
void read_override(Draft& draft, const Override& given);

/// The draft with the priors of every parameter that is not fixed; checked. Touches no file.
/// Throws UserError for the first fault.
Settings complete(const Draft& draft);

/// The settings that a stored configuration describes. Throws UserError.
Settings read_configuration(const std::filesystem::path& file);

/// The settings of a run: defaults <- `configuration` (may be empty) <- `overrides`. A verb that needs a
/// sample has it read, so that faults of the data show here; `out` gets its default and paths become
/// absolute. Throws UserError.
Settings read_settings(std::string_view verb, const std::filesystem::path& configuration,
                       const std::vector<Override>& overrides);

}  // namespace loam::experiments
