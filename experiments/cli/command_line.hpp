// From the words of the command line to a verb and what it is given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/cli/verbs.hpp"
#include "experiments/settings/reading.hpp"

namespace loam::experiments {

struct Command {
    const Verb* verb = nullptr;  // none: only `help` was asked for
    std::string help = {};       // not empty: print this instead of running
    std::filesystem::path configuration = {};
    std::vector<Override> overrides = {};
    PlainArguments plain = {};
};

/// `words` are those after the program's name. Throws lab_data::UserError for an unknown verb or option (with
/// the nearest valid name), a missing or surplus word.
Command parse_command_line(const std::vector<std::string>& words);

}  // namespace loam::experiments
