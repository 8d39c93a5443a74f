// Another program, run as a child that cannot outlive this one and whose output cannot fill the disk.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/ensemble/stop_token.hpp"

namespace loam::experiments {

struct ChildCommand {
    std::filesystem::path program;       // absolute, or relative to `folder`
    std::vector<std::string> arguments;  // without the program's own name
    std::filesystem::path folder;        // where it runs
    std::vector<std::pair<std::string, std::string>> environment =
        {};                           // added to this process's, or in its place
    std::size_t output_kept = 16384;  // bytes
};

struct ChildResult {
    int status = 0;      // exit status; 128 + signal if a signal ended it, as a shell says it
    std::string output;  // the last of what it wrote to standard output and standard error
};

/// The program of that name in a folder of PATH, nothing if there is none.
std::optional<std::filesystem::path> find_program(std::string_view name);

/// Runs it to its end with standard input empty. If `stop` asks for it the child and all that it started are
/// killed, and Interrupted is thrown; if this process dies, whatever the way, the kernel kills the child.
/// Call it from the main thread: the child is tied to the thread that starts it. Throws std::runtime_error if
/// it cannot be started.
ChildResult run_child(const ChildCommand& command, const StopToken& stop);

}  // namespace loam::experiments
