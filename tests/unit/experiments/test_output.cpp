// Atomic files, progress and log.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>

#include "experiments/output/atomic_file.hpp"
#include "experiments/output/log.hpp"
#include "experiments/output/progress.hpp"
#include "experiments/output/storage_error.hpp"
#include "lab_data/user_error.hpp"
#include "tests/unit/experiments/store_helpers.hpp"

namespace loam::experiments {
namespace {

using testing::files_in;
using testing::start_child;
using testing::TemporaryFolder;
using testing::wait_for;

TEST(AtomicFile, ReplacesTheWholeContentAndLeavesNothingElse) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "result.json";
    write_file_atomically(path, std::string(100000, 'a'));
    const std::string second("{\"a\": 1}\n\0binary", 16);
    write_file_atomically(path, second);
    EXPECT_EQ(read_whole_file(path), second);
    EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"result.json"});
}

TEST(AtomicFile, OverwritesATemporaryLeftByAKilledProcess) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "a.tmp", std::string(1000, 'x'));
    write_file_atomically(folder.path() / "a", "new");
    EXPECT_EQ(read_whole_file(folder.path() / "a"), "new");
    EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"a"});
}

TEST(AtomicFile, AMissingFolderIsTheUsersMistake) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "absent" / "result.json";
    try {
        write_file_atomically(path, "x");
        FAIL() << "no error";
    } catch (const lab_data::UserError& error) {
        EXPECT_EQ(error.file(), path.string());
        EXPECT_NE(error.constraint().find("cannot be written: No such file or directory"), std::string::npos);
        EXPECT_NE(error.remedy().find("--out"), std::string::npos);
    }
}

TEST(AtomicFile, WhatCannotBeFinishedLeavesTheOldFileAndNoTemporary) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "result.json";
    write_file_atomically(path, "old");
    const int status = wait_for(start_child([&] {
        const rlimit limit{4096, 4096};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        std::signal(SIGXFSZ, SIG_IGN);
        try {
            write_file_atomically(path, std::string(10000, 'n'));
        } catch (const StorageError& error) {
            return std::string(error.what()).find("limit on file sizes") != std::string::npos ? 0 : 2;
        }
        return 1;
    }));
    EXPECT_EQ(status, 0);
    EXPECT_EQ(read_whole_file(path), "old");
    EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"result.json"});
}

TEST(AtomicFile, AFullDeviceIsSaidToBeFull) {
    // /dev/full answers every write with ENOSPC; the rename is never reached.
    const FileDescriptor full = open_file("/dev/full", O_WRONLY);
    const int error = write_all(full.get(), "x");
    try {
        throw_write_error("ensemble.h5", error);
    } catch (const StorageError& caught) {
        EXPECT_NE(std::string(caught.what()).find("ensemble.h5: the disk is full"), std::string::npos);
        EXPECT_NE(std::string(caught.what()).find("free some space"), std::string::npos);
    }
}

TEST(WritableFolder, IsMadeWithItsParents) {
    const TemporaryFolder folder;
    make_writable_folder(folder.path() / "runs" / "calibrate-sand");
    EXPECT_TRUE(files_in(folder.path() / "runs" / "calibrate-sand").empty());
}

TEST(WritableFolder, WithoutPermissionIsTheUsersMistake) {
    const TemporaryFolder folder;
    ::chmod(folder.path().c_str(), 0555);
    const int status = wait_for(start_child([&] {
        // Root may write anywhere: be nobody.
        if (::geteuid() == 0 && ::setuid(65534) != 0) return 3;
        for (const auto& path : {folder.path(), folder.path() / "below"}) {
            try {
                make_writable_folder(path);
                return 1;
            } catch (const lab_data::UserError& error) {
                if (error.constraint().find("Permission denied") == std::string::npos) return 2;
            }
        }
        return 0;
    }));
    EXPECT_EQ(status, 0);
}

TEST(WritableFolder, AFileInItsPlaceIsTheUsersMistake) {
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "out", "a file");
    EXPECT_THROW(make_writable_folder(folder.path() / "out"), lab_data::UserError);
    EXPECT_THROW(make_writable_folder(folder.path() / "out" / "below"), lab_data::UserError);
}

TEST(Duration, IsRoundedUpToWhatMatters) {
    EXPECT_EQ(format_duration(0), "0 s");
    EXPECT_EQ(format_duration(0.2), "1 s");
    EXPECT_EQ(format_duration(59.5), "1 min 00 s");
    EXPECT_EQ(format_duration(200), "3 min 20 s");
    EXPECT_EQ(format_duration(3599.5), "1 h 00 min");
    EXPECT_EQ(format_duration(7241), "2 h 01 min");
}

/// A progress with a clock to turn and everything it wrote.
struct Screen {
    double now = 100;
    int columns = 80;
    std::string text;
    ProgressOptions options(ProgressStyle style) {
        ProgressOptions result;
        result.style = style;
        result.write = [this](std::string_view part) { text += part; };
        result.columns = [this] { return columns; };
        result.clock = [this] { return now; };
        return result;
    }
    /// What stands on the terminal's last line, columns after the last erasure.
    std::string line() const {
        const std::string erase = "\r\x1b[K";
        const std::size_t start = text.rfind(erase);
        return start == std::string::npos ? text : text.substr(start + erase.size());
    }
};

TEST(ProgressBar, ShowsShareFailuresAndTimeLeft) {
    Screen screen;
    Progress progress("training runs", 200, screen.options(ProgressStyle::bar));
    screen.now += 30;
    progress.update({.done = 50, .reused = 0, .failed = 2});
    // 50 runs in 30 s, 150 to go: 90 s.
    const std::string bar = std::string(6, '#') + std::string(20, '.');
    EXPECT_EQ(screen.line(), "training runs [" + bar + "] 50 of 200, 2 failed, 1 min 30 s left");
    EXPECT_EQ(screen.line().size(), 79u);
}

TEST(ProgressBar, TimeLeftCountsOnlyRunsOfThisSessionAndRunsDown) {
    Screen screen;
    Progress progress("runs", 100, screen.options(ProgressStyle::bar));
    progress.update({.done = 60, .reused = 60, .failed = 0});
    EXPECT_LT(progress.seconds_left(), 0);
    screen.now += 8;
    progress.update({.done = 64, .reused = 60, .failed = 0});
    EXPECT_DOUBLE_EQ(progress.seconds_left(), 72);  // 2 s each, 36 to go
    screen.now += 3;
    progress.update({.done = 64, .reused = 60, .failed = 0});
    EXPECT_DOUBLE_EQ(progress.seconds_left(), 69);
    screen.now += 1000;
    EXPECT_DOUBLE_EQ(progress.seconds_left(), 0);
}

TEST(ProgressBar, RedrawsOnlyWhatChangesAndNotTooOften) {
    Screen screen;
    Progress progress("runs", 100000, screen.options(ProgressStyle::bar));
    for (std::size_t i = 1; i <= 1000; ++i) {
        screen.now += 0.001;
        progress.update({.done = i, .reused = 0, .failed = 0});
    }
    std::size_t redraws = 0;
    for (std::size_t at = screen.text.find('\r'); at != std::string::npos;
         at = screen.text.find('\r', at + 1))
        ++redraws;
    EXPECT_GE(redraws, 9u);
    EXPECT_LE(redraws, 11u);
}

TEST(ProgressBar, IsTakenAwayAtTheEndAndKeepsNotesAboveIt) {
    Screen screen;
    Progress progress("runs", 10, screen.options(ProgressStyle::bar));
    progress.update({.done = 1, .reused = 0, .failed = 0});
    const std::string bar = screen.line();
    screen.text.clear();
    progress.note("run 3 failed: not quasi-static");
    EXPECT_EQ(screen.text, "\r\x1b[Krun 3 failed: not quasi-static\n" + bar);
    progress.finish();
    EXPECT_EQ(screen.line(), "");
    const std::string all = screen.text;
    progress.update({.done = 10, .reused = 0, .failed = 0});
    progress.finish();
    EXPECT_EQ(screen.text, all);
}

TEST(ProgressBar, FitsANarrowTerminal) {
    for (const int columns : {2, 10, 30, 45, 200}) {
        Screen screen;
        screen.columns = columns;
        Progress progress("confirmation runs", 1000, screen.options(ProgressStyle::bar));
        progress.update({.done = 999, .reused = 0, .failed = 100});
        EXPECT_LT(screen.line().size(), static_cast<std::size_t>(columns)) << columns;
        EXPECT_FALSE(screen.line().empty());
    }
}

TEST(ProgressLines, ComeEverySecondsAndOnceAtTheEnd) {
    Screen screen;
    Progress progress("training runs", 40, screen.options(ProgressStyle::lines));
    for (std::size_t i = 0; i <= 40; ++i) {
        progress.update({.done = i, .reused = 0, .failed = 0});
        screen.now += 0.25;
    }
    progress.finish();
    EXPECT_EQ(screen.text,
              "training runs: 0 of 40\n"
              "training runs: 20 of 40, 5 s left\n"
              "training runs: 40 of 40\n");
    EXPECT_EQ(screen.text.find('\x1b'), std::string::npos);
}

TEST(ProgressLines, QuietIsSilent) {
    Screen screen;
    {
        Progress progress("runs", 10, screen.options(ProgressStyle::silent));
        progress.update({.done = 5, .reused = 0, .failed = 0});
        progress.note("something");
    }
    EXPECT_EQ(screen.text, "");
    EXPECT_EQ(progress_style(true), ProgressStyle::silent);
}

TEST(RunLog, AppendsStampedLines) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "log.txt";
    RunLog(path).write("first");
    RunLog(path).write("second\nwith a second line\n");
    std::string text = read_whole_file(path);
    // "2024-05-01T12:00:00Z" with every digit as 0.
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c >= '1' && c <= '9'; }, '0');
    const std::string stamp = "0000-00-00T00:00:00Z ";
    EXPECT_EQ(text, stamp + "first\n" + stamp + "second\n    with a second line\n");
}

TEST(RunLog, AFolderThatIsNotThereIsTheUsersMistake) {
    const TemporaryFolder folder;
    EXPECT_THROW(RunLog(folder.path() / "absent" / "log.txt"), lab_data::UserError);
}

}  // namespace
}  // namespace loam::experiments
