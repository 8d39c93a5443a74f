#include "experiments/workflows/check.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/campaign.hpp"
#include "experiments/settings/reading.hpp"
#include "experiments/settings/validation.hpp"
#include "lab_data/check.hpp"

namespace loam::experiments {
namespace {

using lab_data::CheckReport;
using lab_data::PathKind;
using lab_data::UserError;

const char* kind_text(PathKind kind) {
    switch (kind) {
        case PathKind::sample:
            return "sample";
        case PathKind::data_set:
            return "data set";
        case PathKind::other_file:
            break;
    }
    return "configuration";
}

/// Adds what speaks against simulating the tests of a sample that is sound in itself.
void add_tests(const Settings& settings, const std::filesystem::path& sample, CheckReport& report) {
    if (!report.sound()) return;
    try {
        for (std::string& warning : check_tests(settings, lab_data::read_sample(sample)))
            report.warnings.push_back(std::move(warning));
    } catch (const UserError& error) {
        report.errors.push_back(error);
    }
}

/// Checks the settings, and the sample that they name.
CheckReport check_configuration(const std::filesystem::path& file) {
    CheckReport report;
    report.kind = PathKind::other_file;
    try {
        const Settings settings = read_configuration(file);
        if (!settings.sample.empty()) {
            report = lab_data::check(settings.sample);
            const bool is_sample = report.kind == PathKind::sample;
            if (is_sample) add_tests(settings, settings.sample, report);
            report.kind = PathKind::other_file;
            // What a run would refuse, of the verb that the configuration is for.
            const std::string verb = !settings.verb.empty() ? settings.verb
                                     : is_sample            ? "calibrate"
                                                            : "bulk";
            if (report.sound() && verb != "bench") read_settings(verb, file, {});
        }
        report.contents.insert(
            report.contents.begin(),
            fmt::format("law {}, rotation {}, {} parameters to fit, {} held fixed", settings.law,
                        settings.rotation, settings.priors.size(), settings.set.size()));
    } catch (const UserError& error) {
        report.errors.push_back(error);
    }
    return report;
}

void print_json(const CheckReport& report) {
    nlohmann::json document{{"kind", kind_text(report.kind)}, {"name", report.name},
                            {"sound", report.sound()},        {"contents", report.contents},
                            {"warnings", report.warnings},    {"errors", nlohmann::json::array()}};
    for (const UserError& error : report.errors)
        document["errors"].push_back({{"message", error.what()},
                                      {"file", error.file()},
                                      {"line", error.line()},
                                      {"column", error.column()},
                                      {"value", error.value()},
                                      {"constraint", error.constraint()},
                                      {"remedy", error.remedy()}});
    fmt::print("{}\n", document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void print_text(const CheckReport& report, bool quiet) {
    for (const std::string& warning : report.warnings) fmt::print(stderr, "loam: warning: {}\n", warning);
    for (const UserError& error : report.errors) fmt::print(stderr, "loam: {}\n", error.what());
    if (quiet) return;
    fmt::print("{}{}: {}\n", kind_text(report.kind), report.name.empty() ? "" : " " + report.name,
               report.sound() ? "sound" : fmt::format("{} at fault", report.errors.size()));
    for (const std::string& line : report.contents) fmt::print("  {}\n", line);
}

/// Whatever lies at the path.
CheckReport check_path(const std::filesystem::path& path) {
    const bool is_configuration = lab_data::kind_of(path) == PathKind::other_file;
    CheckReport report = is_configuration ? check_configuration(path) : lab_data::check(path);
    if (report.kind == PathKind::sample) add_tests(Settings{}, path, report);
    return report;
}

}  // namespace

int run_check(const PlainArguments& arguments) {
    CheckReport report;
    report.kind = PathKind::other_file;
    try {
        report = check_path(arguments.path);
    } catch (const UserError& error) {
        if (!arguments.json) throw;
        report.errors.push_back(error);
    }
    if (arguments.json)
        print_json(report);
    else
        print_text(report, arguments.quiet);
    return report.sound() ? 0 : 2;
}

}  // namespace loam::experiments
