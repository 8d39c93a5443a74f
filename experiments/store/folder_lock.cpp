#include "experiments/store/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "experiments/output/storage_error.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {

FolderLock::FolderLock(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / ".lock";
    file_ = open_file(path, O_RDWR | O_CREAT);
    if (!file_) throw_write_error(path, errno);
    int status = 0;
    do {
        status = ::flock(file_.get(), LOCK_EX | LOCK_NB);
    } while (status != 0 && errno == EINTR);
    if (status == 0) return;
    if (errno != EWOULDBLOCK) throw_write_error(path, errno);
    throw lab_data::UserError({.file = folder.string(),
                               .constraint = "is in use: another process is working in this folder",
                               .remedy = "wait for it to end, or choose another folder with --out"});
}

}  // namespace loam::experiments
