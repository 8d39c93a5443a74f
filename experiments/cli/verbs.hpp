// The verbs of the program, one line each: what `loam --help` lists and what is run.
// To add a verb: experiments/workflows/<verb>.{hpp,cpp} with run_<verb>() and one line of the table in
// verbs.cpp.
#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "experiments/settings/settings.hpp"

namespace loam::experiments {

/// What a verb that runs no simulation is given.
struct PlainArguments {
    std::filesystem::path path;  // as the user wrote it
    bool json = false;
    bool quiet = false;
};

/// Does the work and returns the exit status: 0, or another that the verb explains itself. Everything else
/// that goes wrong is thrown (see program.hpp).
using RunWithSettings = int (*)(const Settings&);
using RunPlain = int (*)(const PlainArguments&);

struct Verb {
    std::string_view name;
    std::string_view meaning;   // one line
    std::string_view argument;  // what stands after the verb, as the help shows it: "SAMPLE"; empty: nothing
    std::string_view argument_meaning;
    std::string_view example;  // a command line that works in a fresh checkout
    std::variant<RunWithSettings, RunPlain> run;
};

std::span<const Verb> verbs();

}  // namespace loam::experiments
