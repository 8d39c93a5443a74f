#include "experiments/workflows/benchmarks/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "experiments/output/file_descriptor.hpp"

extern char** environ;

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;

constexpr int poll_ms = 100;  // how late a request to stop may be seen

/// Texts as execve(2) wants them; they must outlive the result.
std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> result;
    for (std::string& text : texts) result.push_back(text.data());
    result.push_back(nullptr);
    return result;
}

std::vector<std::string> environment_of(const ChildCommand& command) {
    std::vector<std::string> texts;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view text(*entry);
        bool is_replaced = false;
        for (const auto& [name, value] : command.environment) is_replaced |= text.starts_with(name + "=");
        if (!is_replaced) texts.emplace_back(text);
    }
    for (const auto& [name, value] : command.environment) texts.push_back(name + "=" + value);
    return texts;
}

/// The child between fork and exec, where only async-signal-safe functions may be called.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment,
                         const char* folder, int output, pid_t parent) {
    setpgid(0, 0);  // a group of its own, so that all that it starts can be killed with it
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // the parent died before the line above
    std::signal(SIGPIPE, SIG_DFL);        // this program ignores it, which exec would hand down
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
        dup2(output, STDERR_FILENO) >= 0 && chdir(folder) == 0)
        execve(program, arguments, environment);
    const char* reason = strerrordesc_np(errno);
    if (reason != nullptr) (void)!write(output, reason, std::strlen(reason));
    _exit(127);
}

/// Kills the child's group and takes the child off the process table, unless it has been waited for.
class Child {
  public:
    explicit Child(pid_t id) : id_(id) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        if (id_ <= 0) return;
        kill(-id_, SIGKILL);
        kill(id_, SIGKILL);  // had it no time yet to found its group
        wait();
    }
    int wait() {
        int status = 0;
        while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
        }
        id_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

  private:
    pid_t id_;
};

/// Reads until the child has closed its output; keeps the last of it.
std::string read_last(int fd, std::size_t kept, const StopToken& stop) {
    std::string output;
    std::array<char, 65536> buffer;
    while (true) {
        stop.throw_if_requested();
        pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
        if (poll(&ready, 1, poll_ms) <= 0) continue;
        const ssize_t count = read(fd, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return output;
        output.append(buffer.data(), static_cast<std::size_t>(count));
        if (output.size() > kept) output.erase(0, output.size() - kept);
    }
}

}  // namespace

std::optional<fs::path> find_program(std::string_view name) {
    const char* path = std::getenv("PATH");
    std::string_view rest = path == nullptr ? "" : path;
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        const fs::path candidate = fs::path(rest.substr(0, end)) / name;
        if (candidate.is_absolute() && fs::is_regular_file(candidate) && access(candidate.c_str(), X_OK) == 0)
            return candidate;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return std::nullopt;
}

ChildResult run_child(const ChildCommand& command, const StopToken& stop) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for another program's output");
    const FileDescriptor reading(ends[0]);
    FileDescriptor writing(ends[1]);
    std::vector<std::string> words{command.program.string()}, settings = environment_of(command);
    words.insert(words.end(), command.arguments.begin(), command.arguments.end());
    const std::vector<char*> arguments = pointers(words), environment = pointers(settings);
    const pid_t parent = getpid(), id = fork();
    if (id < 0) throw std::runtime_error(command.program.string() + " cannot be started");
    if (id == 0)
        become(command.program.c_str(), arguments.data(), environment.data(), command.folder.c_str(),
               writing.get(), parent);
    Child child(id);
    writing = FileDescriptor();
    std::string output = read_last(reading.get(), command.output_kept, stop);
    return {child.wait(), std::move(output)};
}

}  // namespace loam::experiments
