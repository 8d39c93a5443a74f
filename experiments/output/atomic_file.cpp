#include "experiments/output/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "experiments/output/file_descriptor.hpp"
#include "experiments/output/storage_error.hpp"

namespace loam::experiments {
namespace {

/// 0, or errno; the file is closed afterwards.
int write_and_sync(const std::filesystem::path& path, std::string_view content) {
    const FileDescriptor file = open_file(path, O_WRONLY | O_CREAT | O_TRUNC);
    if (!file) return errno;
    if (const int error = write_all(file.get(), content)) return error;
    return ::fsync(file.get()) == 0 ? 0 : errno;
}

}  // namespace

void write_file_atomically(const std::filesystem::path& path, std::string_view content) {
    std::filesystem::path temporary = path;
    temporary += ".tmp";
    int error = write_and_sync(temporary, content);
    if (error == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        throw_write_error(path, error);
    }
    sync_folder(path.parent_path());
}

void make_writable_folder(const std::filesystem::path& folder) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) throw_write_error(folder, failure.value());
    // Permissions say too little (root, read-only mounts, quotas): try it.
    const std::filesystem::path probe = folder / ".writable.tmp";
    const int error = write_and_sync(probe, "x");
    ::unlink(probe.c_str());
    if (error != 0) throw_write_error(folder, error);
}

}  // namespace loam::experiments
