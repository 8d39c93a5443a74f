// Ensembles that are killed, interrupted or run out of disk. What must hold, exactly:
// - a run is FINISHED when the store has it, that is, when EnsembleStore::append has returned;
// - never lost: every finished run is found in the store by whoever opens it next;
// - never run twice: no session starts a run that was in the store when the session began;
// - same bits: ensemble.h5 ends as that of an undisturbed ensemble.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <csignal>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "experiments/ensemble/ensemble.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/output/storage_error.hpp"
#include "tests/unit/experiments/store_helpers.hpp"

namespace loam::experiments {
namespace {

using namespace testing;
using std::chrono::milliseconds;

/// A list of run numbers that outlives the process that writes it: one write a line.
class SideFile {
  public:
    explicit SideFile(const std::filesystem::path& path)
        : file_(open_file(path, O_WRONLY | O_CREAT | O_APPEND)) {}
    void add(std::uint64_t index) { (void)write_all(file_.get(), std::to_string(index) + "\n"); }

    static std::multiset<std::uint64_t> read(const std::filesystem::path& path) {
        std::istringstream text(read_file_if_there(path).value_or(""));
        std::multiset<std::uint64_t> numbers;
        for (std::uint64_t number = 0; text >> number;) numbers.insert(number);
        return numbers;
    }

  private:
    FileDescriptor file_;
};

std::set<std::uint64_t> stored_runs(const std::filesystem::path& folder) {
    std::set<std::uint64_t> found;
    if (!std::filesystem::exists(folder / "ensemble.h5")) return found;
    for (const RunRecord& record : load_ensemble(folder).records) found.insert(record.spec.index);
    return found;
}

std::string undisturbed(const std::vector<RunSpec>& specs, const EnsembleHeader& header) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), header);
    const auto outputs = static_cast<Eigen::Index>(header.outputs.size());
    (void)run_ensemble(store, specs,
                       [&](const RunSpec& spec, const StopToken&) { return toy_run(spec, outputs); });
    return read_whole_file(store.file());
}

/// One session over toy runs, in a process of its own. Writes which runs it started, and which it knows to be
/// on the disk.
int session(const std::filesystem::path& folder, const std::filesystem::path& started_path,
            const std::filesystem::path& finished_path, const std::vector<RunSpec>& specs, bool slow) {
    SideFile started(started_path);
    SideFile finished(finished_path);
    // Checkpoints all the time, so that kills meet them too.
    EnsembleStore store(folder, toy_header(), {.checkpoint_seconds = 0.01});
    const RunFunction run = [&](const RunSpec& spec, const StopToken&) {
        started.add(spec.index);
        if (slow) std::this_thread::sleep_for(milliseconds(4 + splitmix64(spec.index) % 4));
        return toy_run(spec);
    };
    EnsembleOptions options{.jobs = 2, .seconds_between_progress = 0.001};
    options.on_record = [&](const RunRecord& record) { finished.add(record.spec.index); };
    (void)run_ensemble(store, specs, run, options);
    return 0;
}

/// Half of the kills come at any moment, opening the store included; the others after some runs have
/// finished, however slow the machine is today.
void kill_at_a_random_moment(pid_t child, int number, const std::filesystem::path& finished_path,
                             std::mt19937_64& random) {
    if (number % 2 == 0) {
        std::this_thread::sleep_for(milliseconds(random() % 30));
    } else {
        const std::size_t runs = 1 + random() % 12;
        while (SideFile::read(finished_path).size() < runs) std::this_thread::sleep_for(milliseconds(1));
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 8000));
    }
    ::kill(child, SIGKILL);
}

TEST(EnsembleKill, TwentyKillsAtRandomMomentsLoseNothingAndRepeatNothing) {
    constexpr int kills = 20;
    const TemporaryFolder folder;
    const auto run_folder = folder.path() / "run";
    const std::vector<RunSpec> specs =
        toy_specs(1500);  // more than the sessions get done before they are killed
    std::mt19937_64 random(2024);
    std::set<std::uint64_t> stored;  // when the session begins
    for (int number = 0; number <= kills; ++number) {
        const auto started_path = folder.path() / ("started" + std::to_string(number));
        const auto finished_path = folder.path() / ("finished" + std::to_string(number));
        const bool last = number == kills;
        const pid_t child =
            start_child([&] { return session(run_folder, started_path, finished_path, specs, !last); });
        if (!last) kill_at_a_random_moment(child, number, finished_path, random);
        ASSERT_EQ(wait_for(child), last ? 0 : -SIGKILL);

        const auto now_stored = stored_runs(run_folder);
        EXPECT_TRUE(std::includes(now_stored.begin(), now_stored.end(), stored.begin(), stored.end()));
        for (const std::uint64_t index : SideFile::read(finished_path))
            EXPECT_TRUE(now_stored.contains(index)) << "run " << index << " was lost";
        const auto started = SideFile::read(started_path);
        for (const std::uint64_t index : started) {
            EXPECT_FALSE(stored.contains(index)) << "run " << index << " was repeated";
            EXPECT_EQ(started.count(index), 1u);
        }
        stored = now_stored;
    }
    EXPECT_EQ(stored.size(), specs.size());
    EXPECT_EQ(read_whole_file(run_folder / "ensemble.h5"), undisturbed(specs, toy_header()));
    EXPECT_EQ(files_in(run_folder), (std::vector<std::string>{".lock", "ensemble.h5"}));
}

/// Run 7 never ends by itself. Exit status as the command line's.
int interruptible_session(const std::filesystem::path& folder, const std::filesystem::path& finished_path) {
    SideFile finished(finished_path);
    EnsembleStore store(folder, toy_header());
    const RunFunction run = [&](const RunSpec& spec, const StopToken& stop) {
        do {
            std::this_thread::sleep_for(milliseconds(2));
            stop.throw_if_requested();
        } while (spec.index == 7);
        return toy_run(spec);
    };
    EnsembleOptions options{.jobs = 2, .seconds_between_progress = 0.001};
    options.on_record = [&](const RunRecord& record) { finished.add(record.spec.index); };
    try {
        (void)run_ensemble(store, toy_specs(10000), run, options);
    } catch (const Interrupted& interrupted) {
        return interrupted.exit_status;
    }
    return 1;
}

TEST(EnsembleInterrupted, BySignalKeepsEveryFinishedRunAndGivesUpTheOthers) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const TemporaryFolder folder;
        const auto finished_path = folder.path() / "finished";
        const auto run_folder = folder.path() / "run";
        const pid_t child = start_child([&] { return interruptible_session(run_folder, finished_path); });
        while (SideFile::read(finished_path).size() < 12) std::this_thread::sleep_for(milliseconds(2));
        ::kill(child, signal);
        EXPECT_EQ(wait_for(child), 130);
        const auto stored = stored_runs(run_folder);
        for (const std::uint64_t index : SideFile::read(finished_path)) EXPECT_TRUE(stored.contains(index));
        EXPECT_FALSE(stored.contains(7));
        // All of it in the file that others can read.
        EXPECT_EQ(files_in(run_folder), (std::vector<std::string>{".lock", "ensemble.h5"}));
    }
}

TEST(EnsembleInterrupted, AFailureAfterTheSignalIsNotStored) {
    const TemporaryFolder folder;
    EnsembleStore store(folder.path(), toy_header());
    const RunFunction run = [](const RunSpec& spec, const StopToken& stop) -> RunRecord {
        if (spec.index == 3) {
            ::raise(SIGINT);
            EXPECT_TRUE(stop.stop_requested());
            throw std::runtime_error("stopped half-way");  // as a run might that does not know Interrupted
        }
        return toy_run(spec);
    };
    EXPECT_THROW((void)run_ensemble(store, toy_specs(10), run, {.jobs = 1}), Interrupted);
    EXPECT_EQ(store.size(), 3u);
    // The next call is not bothered by the past signal, unless an outer scope still remembers it.
    (void)run_ensemble(store, toy_specs(3), run, {.jobs = 1});
    const SignalScope outer;
    ::raise(SIGINT);
    EXPECT_THROW((void)run_ensemble(store, toy_specs(5), run, {.jobs = 1}), Interrupted);
    EXPECT_EQ(store.size(), 3u);
}

TEST(EnsembleInterrupted, ASecondSignalEndsARunThatDoesNotListen) {
    const TemporaryFolder folder;
    const auto started_path = folder.path() / "started";
    const pid_t child = start_child([&] {
        SideFile started(started_path);
        EnsembleStore store(folder.path() / "run", toy_header());
        const RunFunction run = [&](const RunSpec& spec, const StopToken&) {
            started.add(spec.index);
            for (;;) std::this_thread::sleep_for(milliseconds(100));
            return toy_run(spec);
        };
        (void)run_ensemble(store, toy_specs(1), run);
        return 0;
    });
    while (SideFile::read(started_path).empty()) std::this_thread::sleep_for(milliseconds(2));
    ::kill(child, SIGINT);
    std::this_thread::sleep_for(milliseconds(30));
    ::kill(child, SIGINT);
    EXPECT_EQ(wait_for(child), -SIGINT);
}

constexpr std::size_t wide = 500;  // outputs of the runs that fill a disk: 4 kB each

RunRecord wide_run(const RunSpec& spec, const StopToken&) {
    return toy_run(spec, wide);
}

/// Fills the small space that is left, makes room, and goes on. Exit status: 0 as it should be, else the
/// step.
int full_disk_session(const std::filesystem::path& folder, const std::string& expected_text,
                      const std::function<void()>& make_room, const std::filesystem::path& result) {
    std::set<std::uint64_t> finished;
    {
        EnsembleStore store(folder, toy_header(wide));
        EnsembleOptions options{.jobs = 1};
        options.on_record = [&](const RunRecord& record) { finished.insert(record.spec.index); };
        try {
            (void)run_ensemble(store, toy_specs(40), wide_run, options);
            return 1;
        } catch (const StorageError& error) {
            if (std::string(error.what()).find(expected_text) == std::string::npos) return 2;
        }
        if (store.size() != finished.size() || finished.empty()) return 3;
    }
    if (stored_runs(folder) != finished) return 4;
    for (const std::string& name : files_in(folder))
        if (name.ends_with(".tmp")) return 5;
    make_room();
    EnsembleStore store(folder, toy_header(wide));
    if (store.size() != finished.size() || store.recovery().damaged_bytes > 0) return 6;
    if (run_ensemble(store, toy_specs(40), wide_run).reused != finished.size()) return 7;
    write_file_atomically(result, read_whole_file(store.file()));
    return 0;
}

/// Mounts a file system of 800 kB that only this (child) process sees. False where that is not allowed.
bool mount_small_disk(const std::filesystem::path& place) {
    const int spaces = ::geteuid() == 0 ? CLONE_NEWNS : CLONE_NEWNS | CLONE_NEWUSER;
    if (::unshare(spaces) != 0) return false;
    if (::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return false;
    return ::mount("tmpfs", place.c_str(), "tmpfs", 0, "size=800k") == 0;
}

int limited_files_session(const std::filesystem::path& folder, const std::filesystem::path& result) {
    const auto limit_to = [](rlim_t bytes) {
        const rlimit limit{bytes, RLIM_INFINITY};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    };
    const SignalScope signals;  // as the command line holds one: SIGXFSZ does not kill
    limit_to(100 * 1024);
    return full_disk_session(
        folder, "past the limit on file sizes", [&] { limit_to(RLIM_INFINITY); }, result);
}

TEST(EnsembleFullDisk, SaysSoAndGoesOnWhenThereIsRoom) {
    const TemporaryFolder folder;
    const auto disk = folder.path() / "disk";
    std::filesystem::create_directory(disk);
    const auto result = folder.path() / "result.h5";
    const int status = wait_for(start_child([&] {
        // Where mounting is not allowed, a limit on file sizes has to do.
        if (!mount_small_disk(disk)) return limited_files_session(disk, result);
        write_file_atomically(disk / "ballast", std::string(700 * 1024, 'b'));
        return full_disk_session(
            disk / "run", "the disk is full", [&] { std::filesystem::remove(disk / "ballast"); }, result);
    }));
    EXPECT_EQ(status, 0);
    EXPECT_EQ(read_whole_file(result), undisturbed(toy_specs(40), toy_header(wide)));
}

TEST(EnsembleFullDisk, ALimitOnFileSizesIsTreatedLikewise) {
    const TemporaryFolder folder;
    const auto result = folder.path() / "result.h5";
    EXPECT_EQ(wait_for(start_child([&] { return limited_files_session(folder.path() / "run", result); })), 0);
    EXPECT_EQ(read_whole_file(result), undisturbed(toy_specs(40), toy_header(wide)));
}

/// Appends five runs where ensemble.h5 has no room to grow; the checkpoint comes by itself after the first,
/// or is asked for in the end.
int crowded_session(const std::filesystem::path& folder, bool by_itself) {
    const SignalScope signals;
    EnsembleStore store(folder, toy_header(wide), {.checkpoint_seconds = by_itself ? 0.001 : 60});
    const std::string before = read_whole_file(store.file());
    const rlimit limit{before.size() + 1000, RLIM_INFINITY};  // a run takes 4 kB more
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
        for (std::uint64_t index = 0; index < 5; ++index) {
            if (by_itself) std::this_thread::sleep_for(milliseconds(2));
            store.append(toy_run(toy_spec(index), wide));
        }
        if (by_itself) return 1;
        store.checkpoint();
        return 2;
    } catch (const StorageError&) {
    }
    if (read_whole_file(store.file()) != before) return 3;
    return stored_runs(folder).size() == (by_itself ? 1 : 5) ? 0 : 4;
}

/// No room for a checkpoint's second copy of the file, though for the journal: nothing is lost either.
TEST(EnsembleFullDisk, ACheckpointWithoutRoomLeavesFileAndJournalAsTheyWere) {
    for (const bool by_itself : {false, true}) {
        const TemporaryFolder folder;
        EXPECT_EQ(wait_for(start_child([&] { return crowded_session(folder.path(), by_itself); })), 0)
            << by_itself;
        EXPECT_EQ(files_in(folder.path()),
                  (std::vector<std::string>{".lock", "ensemble.h5", "ensemble.journal"}));
    }
}

}  // namespace
}  // namespace loam::experiments
