// What the tests of the store, the ensemble and the output share: a folder that goes away, a toy campaign
// with known results, and code run in a child process that may be killed, limited or given a small disk.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiments/ensemble/run_record.hpp"
#include "experiments/output/file_descriptor.hpp"
#include "experiments/store/h5_file.hpp"
#include "experiments/store/header.hpp"
#include "experiments/store/journal.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments::testing {

class TemporaryFolder {
  public:
    TemporaryFolder() {
        // In memory where possible: these tests sync thousands of times, and a kill (unlike a power cut) does
        // not care what the files are on.
        const bool memory = ::access("/dev/shm", W_OK | X_OK) == 0;
        std::string name = (memory ? std::string("/dev/shm/") : ::testing::TempDir()) + "loam-XXXXXX";
        if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
        std::filesystem::permissions(name, std::filesystem::perms(0755));
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline EnsembleHeader toy_header(std::size_t outputs = 3) {
    EnsembleHeader header;
    header.campaign_seed = 42;
    header.parameters = {{"young_modulus", "Pa", 1e7, 1e10}, {"friction_angle", "rad", 0.05, 0.8}};
    for (std::size_t i = 0; i < outputs; ++i)
        header.outputs.push_back({"oedometer_1.csv", "axial_strain", "", "axial_stress", "Pa",
                                  1000.0 * static_cast<double>(i + 1)});
    header.diagnostics = {{"inertial_number_max", ""}, {"porosity", ""}};
    header.attributes = {{"law", "linear-cohesive"}, {"rotation", "blocked"}, {"version", "0.1.0"}};
    return header;
}

inline RunSpec toy_spec(std::uint64_t index) {
    RunSpec spec;
    spec.index = index;
    spec.purpose = index % 3 == 0 ? "replicate" : "training";
    const auto x = static_cast<double>(index);
    spec.parameters = Eigen::Vector2d(1e8 + 1e5 * x, 0.3 + 0.001 * x);
    spec.packing_seed = 1000000007u * (index + 1);
    spec.particles = 700;
    return spec;
}

/// Every seventh run fails.
inline RunRecord toy_run(const RunSpec& spec, Eigen::Index outputs = 3) {
    RunRecord record;
    record.spec = spec;
    record.ok = spec.index % 7 != 6;
    record.diagnostics = Eigen::Vector2d(1e-4, 0.4);
    if (!record.ok) {
        record.reason = "not quasi-static: inertial number 0.02";
        return record;
    }
    record.outputs.resize(outputs);
    for (Eigen::Index i = 0; i < outputs; ++i)
        record.outputs[i] = std::sin(spec.parameters[1] * static_cast<double>(i + 1)) / 3;
    return record;
}

inline std::vector<RunSpec> toy_specs(std::uint64_t count) {
    std::vector<RunSpec> specs;
    for (std::uint64_t index = 0; index < count; ++index) specs.push_back(toy_spec(index));
    return specs;
}

inline EnsembleContents toy_contents(std::uint64_t runs) {
    EnsembleContents contents{toy_header(), {}};
    for (const RunSpec& spec : toy_specs(runs)) contents.records.push_back(toy_run(spec));
    return contents;
}

inline void expect_same(const std::vector<RunRecord>& a, const std::vector<RunRecord>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(same_record(a[i], b[i])) << "record " << i;
}

/// The file, constraint and remedy of the UserError that `work` throws; empty if it throws none.
inline std::string error_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const lab_data::UserError& error) {
        return error.file() + ": " + error.constraint() + "; " + error.remedy();
    }
    return "";
}

/// The bytes of a journal of these records.
inline std::string journal_of(const std::vector<RunRecord>& records, const EnsembleHeader& header) {
    const TemporaryFolder folder;
    Journal journal(folder.path() / "j", fingerprint(header));
    for (const RunRecord& record : records) journal.append(record);
    return read_whole_file(folder.path() / "j");
}

inline std::vector<std::string> files_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// Starts `work` in a child process; its exit status is what `work` returns, 99 if that throws.
inline pid_t start_child(const std::function<int()>& work) {
    const pid_t child = ::fork();
    if (child != 0) return child;
    int status = 99;
    try {
        status = work();
    } catch (const std::exception& error) {
        (void)write_all(STDERR_FILENO, std::string("child: ") + error.what() + "\n");
    }
    ::_exit(status);
}

/// The exit status, or minus the signal that ended the child.
inline int wait_for(pid_t child) {
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace loam::experiments::testing
