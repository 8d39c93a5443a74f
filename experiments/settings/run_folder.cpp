#include "experiments/settings/run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>

#include "experiments/output/atomic_file.hpp"
#include "experiments/output/file_descriptor.hpp"
#include "experiments/settings/reading.hpp"
#include "experiments/settings/writing.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;
using lab_data::UserError;

constexpr const char* foreign = "holds a config.toml that is not of a run";

/// Holds the folder for this process; the kernel lets go of it when the process ends, however it ends.
FileDescriptor lock_folder(const fs::path& folder) {
    FileDescriptor descriptor = open_file(folder, O_RDONLY | O_DIRECTORY);
    if (descriptor && ::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        throw UserError({.column = "--out",
                         .value = folder.string(),
                         .constraint = "is in use by another loam",
                         .remedy = "wait for it to end, or give another --out"});
    return descriptor;
}

/// Whether the folder holds something that is not left over from starting a run in it.
bool holds_other_things(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() != ".tmp") return true;
    return false;
}

/// Whether a run was begun in the folder but came to no simulation, and nothing else lies there.
bool has_no_more_than_a_start(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
        const fs::path name = entry.path().filename();
        if (name != "config.toml" && name != "log.txt" && name != ".lock" && name.extension() != ".tmp")
            return false;
    }
    return true;
}

UserError not_of_a_run(const fs::path& folder, std::string constraint) {
    return UserError({.column = "--out",
                      .value = folder.string(),
                      .constraint = std::move(constraint) + ", so it is not the folder of a run",
                      .remedy = "give a new or an empty folder"});
}

/// Whether a configuration was written for a run, not by the user.
bool is_of_a_run(const fs::path& configuration) {
    return read_whole_file(configuration).starts_with(first_words);
}

/// Whether a configuration that may be out of date has these settings.
bool has_settings(const fs::path& configuration, const Settings& settings) {
    try {
        return first_difference(read_configuration(configuration), settings).empty();
    } catch (const UserError&) {
        return false;
    }
}

/// `stored` is what the configuration says.
void demand_same_settings(const fs::path& configuration, const Settings& stored, const Settings& now) {
    const std::string path = first_difference(stored, now);
    if (path.empty()) return;
    if (path == "inputs_digest")
        throw UserError(
            {.file = configuration.string(),
             .column = path,
             .constraint =
                 "tells that the run was made with other data: the sample or the packing has changed since",
             .remedy = "give another --out, or delete the folder to start anew"});
    const auto shown = [&](const Settings& settings) {
        const std::string text = value_text(settings, path);
        return text.empty() ? std::string("not set") : text;
    };
    throw UserError(
        {.file = configuration.string(),
         .column = path,
         .constraint = fmt::format("is {} in the run stored there and {} now", shown(stored), shown(now)),
         .remedy = "use the same settings to continue it, or give another --out"});
}

}  // namespace

RunFolder::RunFolder(const Settings& settings) : path_(settings.out) {
    make_writable_folder(path_);
    lock_ = lock_folder(path_);
    const fs::path configuration = file("config.toml");
    resumed_ = fs::exists(configuration);
    if (!resumed_ && holds_other_things(path_)) throw not_of_a_run(path_, "holds files but no config.toml");
    if (resumed_) {
        if (has_settings(configuration, settings)) return;
        if (!is_of_a_run(configuration)) throw not_of_a_run(path_, foreign);
        if (!has_no_more_than_a_start(path_)) {
            demand_same_settings(configuration, read_configuration(configuration), settings);
            return;
        }
    }
    write_file_atomically(configuration, to_toml(settings));
}

void spare_configuration(const fs::path& given, const Settings& settings) {
    const fs::path configuration = settings.out / "config.toml";
    std::error_code failure;
    const bool is_the_same = fs::equivalent(given, configuration, failure);
    if (!is_the_same || !has_no_more_than_a_start(settings.out)) return;
    if (!is_of_a_run(configuration)) throw not_of_a_run(settings.out, foreign);
    Settings stored = read_configuration(configuration);
    // Data that were mended since are no setting that would be lost.
    stored.inputs_digest = settings.inputs_digest;
    demand_same_settings(configuration, stored, settings);
}

}  // namespace loam::experiments
