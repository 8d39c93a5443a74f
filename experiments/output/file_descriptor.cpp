#include "experiments/output/file_descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "experiments/output/storage_error.hpp"

namespace loam::experiments {

FileDescriptor::~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
}

FileDescriptor::FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
}

FileDescriptor open_file(const std::filesystem::path& path, int flags) {
    int fd = -1;
    do {
        fd = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    } while (fd < 0 && errno == EINTR);
    return FileDescriptor(fd);
}

int write_all(int fd, std::string_view content) {
    while (!content.empty()) {
        const ssize_t written = ::write(fd, content.data(), content.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        // Part of the bytes: the next call says why (or writes the rest).
        content.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

std::optional<std::string> read_file_if_there(const std::filesystem::path& path) {
    const FileDescriptor file = open_file(path, O_RDONLY);
    if (!file && errno == ENOENT) return std::nullopt;
    if (!file) throw_read_error(path, errno);
    std::string content;
    std::array<char, 1 << 16> buffer;
    for (;;) {
        const ssize_t got = ::read(file.get(), buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw_read_error(path, errno);
        if (got == 0) return content;
        content.append(buffer.data(), static_cast<std::size_t>(got));
    }
}

std::string read_whole_file(const std::filesystem::path& path) {
    std::optional<std::string> content = read_file_if_there(path);
    if (!content) throw_read_error(path, ENOENT);
    return *std::move(content);
}

void sync_folder(const std::filesystem::path& folder) {
    const std::filesystem::path place = folder.empty() ? "." : folder;
    const FileDescriptor file = open_file(place, O_RDONLY | O_DIRECTORY);
    if (!file) throw_write_error(place, errno);
    // Some network file systems cannot sync a folder and say EINVAL; there the rename itself is all there is.
    if (::fsync(file.get()) != 0 && errno != EINVAL) throw_write_error(place, errno);
}

}  // namespace loam::experiments
