#include "experiments/output/log.hpp"

#include <fcntl.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <string>

#include "experiments/output/storage_error.hpp"

namespace loam::experiments {
namespace {

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    std::array<char, 32> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return {text.data(), length};
}

}  // namespace

RunLog::RunLog(const std::filesystem::path& path) : file_(open_file(path, O_WRONLY | O_CREAT | O_APPEND)) {
    if (!file_) throw_write_error(path, errno);
}

void RunLog::write(std::string_view text) {
    while (text.ends_with('\n')) text.remove_suffix(1);
    std::string line = utc_now() + " ";
    for (const char c : text) {
        line += c;
        if (c == '\n') line += "    ";
    }
    line += '\n';
    const std::scoped_lock lock(mutex_);
    // One write a line: lines of two processes do not mix.
    (void)write_all(file_.get(), line);
}

}  // namespace loam::experiments
