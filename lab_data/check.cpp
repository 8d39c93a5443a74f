#include "lab_data/check.hpp"

#include <algorithm>
#include <optional>

#include "lab_data/gather.hpp"
#include "lab_data/shown.hpp"

namespace loam::lab_data {
namespace fs = std::filesystem;
namespace {

void report_sample(const fs::path& path, CheckReport& report, Faults& faults) {
    const Sample sample = gather_sample(path, faults);
    report.name = sample.name;
    for (const Test& test : sample.tests)
        report.contents.push_back(std::string(to_string(test.kind)) + " " + test.file + ": " +
                                  std::to_string(test.size()) + " readings");
}

void report_data_set(const fs::path& path, CheckReport& report, Faults& faults) {
    const DataSet set = gather_data_set(path, faults);
    report.name = set.name;
    const auto readable = std::ranges::count_if(set.rows, &DataSetRow::readable);
    if (!set.rows.empty())
        report.contents.push_back(std::string(to_string(set.kind)) + ": " + std::to_string(readable) +
                                  " of " + std::to_string(set.rows.size()) + " samples readable, " +
                                  std::to_string(set.covariates.size()) + " covariates");
    for (const DataSetRow& row : set.rows) {
        if (row.readable()) continue;
        faults.errors.push_back(std::get<UserError>(row.test));
        faults.errors.insert(faults.errors.end(), row.more_faults.begin(), row.more_faults.end());
    }
}

/// By line within each file; the files in the order in which they were read.
void sort_by_line(std::vector<UserError>& errors) {
    for (auto begin = errors.begin(); begin != errors.end();) {
        const auto end =
            std::find_if(begin, errors.end(), [&](const UserError& e) { return e.file() != begin->file(); });
        std::stable_sort(begin, end,
                         [](const UserError& a, const UserError& b) { return a.line() < b.line(); });
        begin = end;
    }
}

/// The folder of the sample or data set that a curve lies in, which may be some folders above it.
std::optional<fs::path> folder_around(const fs::path& file) {
    constexpr int most_levels = 3;
    std::error_code error;
    fs::path folder = file.parent_path();
    for (int level = 0; level < most_levels; ++level, folder = folder.parent_path()) {
        const fs::path named = folder.empty() ? fs::path(".") : folder;
        if (fs::exists(named / sample_file, error) || fs::exists(named / data_set_file, error)) return named;
        if (folder.empty()) break;
    }
    return std::nullopt;
}

/// A table is nothing by itself: what its numbers mean stands in another file.
UserError is_table(const fs::path& path) {
    const auto folder = folder_around(path);
    return UserError({.file = path.string(),
                      .constraint = "is a table, which is checked with the sample or data set that names it",
                      .remedy = folder ? "name the folder '" + shown(folder->string()) + "'"
                                       : "name the folder that holds its sample.toml or dataset.toml"});
}

}  // namespace

PathKind kind_of(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::regular) {
        if (path.filename() == sample_file) return PathKind::sample;
        if (path.filename() == data_set_file) return PathKind::data_set;
        if (path.extension() == ".csv" || path.extension() == ".CSV") throw is_table(path);
        return PathKind::other_file;
    }
    Faults faults;
    if (status.type() != fs::file_type::directory && !locate(path, sample_file, faults))
        throw faults.errors.front();
    const bool sample = fs::exists(path / sample_file, error),
               data_set = fs::exists(path / data_set_file, error);
    if (sample && !data_set) return PathKind::sample;
    if (data_set && !sample) return PathKind::data_set;
    throw UserError({.file = path.string(),
                     .constraint = sample ? "holds both a sample.toml and a dataset.toml"
                                          : "holds neither a sample.toml nor a dataset.toml",
                     .remedy = sample ? "put them into folders of their own"
                                      : "name the folder of a sample or data set"});
}

CheckReport check(const fs::path& path) {
    CheckReport report;
    report.kind = kind_of(path);
    if (report.kind == PathKind::other_file)
        throw UserError({.file = path.string(),
                         .constraint = "is neither a sample nor a data set",
                         .remedy = "name the folder of one, or its sample.toml or dataset.toml"});
    Faults faults;
    if (report.kind == PathKind::data_set)
        report_data_set(path, report, faults);
    else
        report_sample(path, report, faults);
    sort_by_line(faults.errors);
    report.errors = std::move(faults.errors);
    report.warnings = std::move(faults.warnings);
    return report;
}

}  // namespace loam::lab_data
