#include "experiments/output/storage_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

std::string system_text(int error) {
    return std::generic_category().message(error);
}

}  // namespace

void throw_write_error(const std::filesystem::path& path, int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT:
            throw StorageError(fmt::format(
                "{}: the disk is full ({}); free some space and give the same command again, what "
                "was finished before is kept",
                path.string(), system_text(error)));
        case EFBIG:
            throw StorageError(
                fmt::format("{}: the file would grow past the limit on file sizes ({}); raise it (ulimit -f) "
                            "and give the "
                            "same command again, what was finished before is kept",
                            path.string(), system_text(error)));
        case EACCES:
        case EPERM:
        case EROFS:
        case ENOENT:
        case EEXIST:  // a link that leads nowhere stands where a folder is to be made
        case ENOTDIR:
        case EISDIR:
        case ENAMETOOLONG:
            throw lab_data::UserError({.file = path.string(),
                                       .constraint = "cannot be written: " + system_text(error),
                                       .remedy = "choose a folder that can be written with --out"});
        default:
            throw StorageError(fmt::format("{}: writing failed: {}", path.string(), system_text(error)));
    }
}

void throw_read_error(const std::filesystem::path& path, int error) {
    throw lab_data::UserError({.file = path.string(),
                               .constraint = "cannot be read: " + system_text(error),
                               .remedy = "check that it exists and may be read"});
}

}  // namespace loam::experiments
