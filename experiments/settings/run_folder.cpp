#include "experiments/settings/run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>

#include "experiments/output/atomic_file.hpp"
#include "experiments/settings/reading.hpp"
#include "experiments/settings/writing.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

namespace fs = std::filesystem;
using lab_data::UserError;

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

/// Whether a run was begun in the folder but came to no simulation: its input was at fault.
bool came_to_nothing(const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name != "config.toml" && name != "log.txt" && !name.starts_with('.')) return false;
    }
    return true;
}

void demand_same_settings(const fs::path& configuration, const Settings& now) {
    const Settings stored = read_configuration(configuration);
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
    if (resumed_ && !came_to_nothing(path_)) {
        demand_same_settings(configuration, settings);
        return;
    }
    if (!resumed_ && holds_other_things(path_))
        throw UserError({.column = "--out",
                         .value = path_.string(),
                         .constraint = "holds files but no config.toml, so it is not the folder of a run",
                         .remedy = "give a new or an empty folder"});
    write_file_atomically(configuration, to_toml(settings));
}

}  // namespace loam::experiments
