// Other programs as children: what is kept of their output, how they end, and that they end with this one.
#include <csignal>
#include <thread>

#include "experiments/workflows/benchmarks/child_process.hpp"
#include "store_helpers.hpp"

namespace loam::experiments {
namespace {

using namespace std::chrono_literals;
using testing::TemporaryFolder;

ChildCommand shell(const std::string& script, const std::filesystem::path& folder = "/") {
    return {.program = "/bin/sh", .arguments = {"-c", script}, .folder = folder};
}

bool is_alive(pid_t id) {
    // A killed process that nobody has waited for yet is not alive.
    const auto status = read_file_if_there("/proc/" + std::to_string(id) + "/stat");
    return status && status->find(") Z ") == std::string::npos;
}

bool ends_soon(pid_t id) {
    for (int k = 0; k < 100 && is_alive(id); ++k) std::this_thread::sleep_for(50ms);
    return !is_alive(id);
}

/// The number that a child writes into a file, once it is there whole (with its line end).
pid_t id_in(const std::filesystem::path& file) {
    for (int k = 0; k < 200; ++k) {
        const auto text = read_file_if_there(file);
        if (text && text->ends_with('\n')) return std::stoi(*text);
        std::this_thread::sleep_for(50ms);
    }
    throw std::runtime_error("the child never wrote " + file.string());
}

TEST(ChildProcess, SaysStatusAndOutputOfBothStreams) {
    const ChildResult result = run_child(shell("echo out; echo err >&2; exit 3"), {});
    EXPECT_EQ(result.status, 3);
    EXPECT_EQ(result.output, "out\nerr\n");
    EXPECT_EQ(run_child(shell("kill -9 $$"), {}).status, 128 + SIGKILL);
}

TEST(ChildProcess, KeepsTheLastOfALongOutput) {
    ChildCommand command = shell("yes warning | head -c 5000000; echo end");
    command.output_kept = 1000;
    const ChildResult result = run_child(command, {});
    EXPECT_EQ(result.output.size(), 1000u);
    EXPECT_TRUE(result.output.ends_with("end\n"));
}

TEST(ChildProcess, RunsInItsFolderWithItsEnvironmentAndNoInput) {
    const TemporaryFolder folder;
    ChildCommand command = shell("pwd; echo $HOME $LOAM_TEST; cat; env | grep -c ^HOME=", folder.path());
    command.environment = {{"HOME", "/nowhere"}, {"LOAM_TEST", "a b"}};
    EXPECT_EQ(run_child(command, {}).output, folder.path().string() + "\n/nowhere a b\n1\n");
}

TEST(ChildProcess, SaysWhyAProgramDoesNotStart) {
    ChildCommand command = shell("");
    command.program = "/nowhere/program";
    const ChildResult result = run_child(command, {});
    EXPECT_EQ(result.status, 127);
    EXPECT_EQ(result.output, "No such file or directory");
}

TEST(ChildProcess, IsKilledWithAllItStartedWhenAskedToStop) {
    const TemporaryFolder folder;
    std::atomic<bool> stop{false};
    std::jthread asker([&] {
        id_in(folder.path() / "id");
        stop = true;
    });
    EXPECT_THROW(run_child(shell("sleep 300 & echo $! > id; wait", folder.path()), StopToken(stop)),
                 Interrupted);
    EXPECT_TRUE(ends_soon(id_in(folder.path() / "id")));
}

TEST(ChildProcess, DiesWithThisProcess) {
    const TemporaryFolder folder;
    const pid_t parent = testing::start_child([&] {
        run_child(shell("echo $$ > id; exec sleep 300", folder.path()), {});
        return 0;
    });
    const pid_t grandchild = id_in(folder.path() / "id");
    ASSERT_TRUE(is_alive(grandchild));
    kill(parent, SIGKILL);
    testing::wait_for(parent);
    EXPECT_TRUE(ends_soon(grandchild));
}

TEST(FindProgram, LooksAlongThePath) {
    EXPECT_TRUE(find_program("sh").has_value());
    EXPECT_FALSE(find_program("no-such-program-anywhere").has_value());
}

}  // namespace
}  // namespace loam::experiments
