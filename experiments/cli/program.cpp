#include "experiments/cli/program.hpp"

#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiments/cli/command_line.hpp"
#include "experiments/ensemble/stop_token.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

constexpr int failed = 1;
constexpr int input_at_fault = 2;

int run_verb(const Command& command) {
    if (const auto* run = std::get_if<RunPlain>(&command.verb->run)) return (*run)(command.plain);
    const Settings settings = read_settings(command.verb->name, command.configuration, command.overrides);
    const SignalScope signals;
    return std::get<RunWithSettings>(command.verb->run)(settings);
}

int run(const std::vector<std::string>& words) {
    const Command command = parse_command_line(words);
    int status = 0;
    if (command.help.empty())
        status = run_verb(command);
    else
        std::fputs(command.help.c_str(), stdout);
    std::fflush(stdout);
    return status;
}

constexpr const char* unwritable = "standard output could not be written";

/// Whether a path itself is at fault, not what lies there.
bool is_of_the_name(const std::error_code& code) {
    return code == std::errc::filename_too_long || code == std::errc::too_many_symbolic_link_levels ||
           code == std::errc::not_a_directory;
}

int report(const char* reason, int status) {
    std::fprintf(stderr, "loam: %s\n", reason);
    return status;
}

}  // namespace

int run_program(int argc, const char* const* argv) {
    // A reader that closes the pipe early is an error of writing like any other, not a silent end.
    std::signal(SIGPIPE, SIG_IGN);
    try {
        const int status = run({argv + 1, argv + argc});
        return std::ferror(stdout) == 0 ? status : report(unwritable, failed);
    } catch (const lab_data::UserError& error) {
        return report(error.what(), input_at_fault);
    } catch (const Interrupted& interrupted) {
        return report(interrupted.what(), Interrupted::exit_status);
    } catch (const std::filesystem::filesystem_error& error) {
        if (!is_of_the_name(error.code())) return report(error.what(), failed);
        const lab_data::UserError at_fault({.file = error.path1().string(),
                                            .constraint = error.code().message(),
                                            .remedy = "give another path"});
        return report(at_fault.what(), input_at_fault);
    } catch (const std::bad_alloc&) {
        return report("out of memory; fewer --jobs or --particles need less", failed);
    } catch (const std::exception& error) {
        return report(std::ferror(stdout) == 0 ? error.what() : unwritable, failed);
    }
}

}  // namespace loam::experiments
