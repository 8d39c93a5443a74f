#include "experiments/output/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "experiments/output/file_descriptor.hpp"

namespace loam::experiments {
namespace {

constexpr std::string_view erase_line = "\r\x1b[K";

void write_to_stderr(std::string_view text) {
    // Progress that cannot be shown is no reason to stop.
    (void)write_all(STDERR_FILENO, text);
}

int terminal_columns() {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
    return size.ws_col;
}

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

ProgressStyle progress_style(bool quiet) {
    if (quiet) return ProgressStyle::silent;
    const char* terminal = std::getenv("TERM");
    const bool can_redraw = terminal != nullptr && std::string_view(terminal) != "dumb";
    return can_redraw && ::isatty(STDERR_FILENO) == 1 ? ProgressStyle::bar : ProgressStyle::lines;
}

std::string format_duration(double seconds) {
    const double whole_seconds = std::ceil(std::max(seconds, 0.0));
    if (whole_seconds < 60) return fmt::format("{:.0f} s", whole_seconds);
    if (whole_seconds < 3600) {
        const double minutes = std::floor(whole_seconds / 60);
        return fmt::format("{:.0f} min {:02.0f} s", minutes, whole_seconds - 60 * minutes);
    }
    const double minutes = std::ceil(whole_seconds / 60);
    const double hours = std::floor(minutes / 60);
    return fmt::format("{:.0f} h {:02.0f} min", hours, minutes - 60 * hours);
}

Progress::Progress(std::string title, std::size_t total, ProgressOptions options)
    : title_(std::move(title)), total_(total), options_(std::move(options)) {
    if (!options_.write) options_.write = write_to_stderr;
    if (!options_.columns) options_.columns = terminal_columns;
    if (!options_.clock) options_.clock = steady_seconds;
    start_ = options_.clock();
    last_finish_ = start_;
    last_shown_ = -std::numeric_limits<double>::infinity();
}

Progress::~Progress() {
    finish();
}

double Progress::seconds_left() const {
    const std::size_t executed = count_.done - std::min(count_.reused, count_.done);
    if (count_.done >= total_) return 0;
    if (executed == 0) return -1;
    const double pace = (last_finish_ - start_) / static_cast<double>(executed);
    const double left = pace * static_cast<double>(total_ - count_.done);
    return std::max(0.0, left - (options_.clock() - last_finish_));
}

std::string Progress::text(bool with_bar) const {
    std::string tail = fmt::format("{} of {}", count_.done, total_);
    if (count_.failed > 0) tail += fmt::format(", {} failed", count_.failed);
    const double left = seconds_left();
    if (count_.done < total_ && left >= 0) tail += fmt::format(", {} left", format_duration(left));
    if (!with_bar) return title_ + ": " + tail;

    // The last column stays free: a character there makes some terminals wrap.
    const auto columns = static_cast<std::size_t>(std::max(1, options_.columns() - 1));
    constexpr std::size_t shortest_bar = 8;
    constexpr std::size_t longest_bar = 40;
    const std::size_t taken = title_.size() + tail.size() + 4;  // "title [bar] tail"
    std::string line = title_ + " " + tail;
    if (taken + shortest_bar <= columns) {
        const std::size_t width = std::min(longest_bar, columns - taken);
        const std::size_t filled = total_ == 0 ? width : width * std::min(count_.done, total_) / total_;
        line = fmt::format("{} [{}{}] {}", title_, std::string(filled, '#'), std::string(width - filled, '.'),
                           tail);
    }
    return line.substr(0, columns);
}

void Progress::draw() {
    const bool bar = options_.style == ProgressStyle::bar;
    const std::string now_shown = text(bar);
    if (now_shown == shown_) return;
    // One write: the terminal never shows a half-erased line.
    options_.write(bar ? fmt::format("{}{}", erase_line, now_shown) : now_shown + "\n");
    shown_ = now_shown;
    last_shown_ = options_.clock();
}

void Progress::update(const ProgressCount& count) {
    if (finished_) return;
    if (count.done > count_.done + (count.reused - count_.reused)) last_finish_ = options_.clock();
    count_ = count;
    if (options_.style == ProgressStyle::silent) return;
    const double interval = options_.style == ProgressStyle::bar ? options_.seconds_between_redraws
                                                                 : options_.seconds_between_lines;
    if (options_.clock() - last_shown_ >= interval) draw();
}

void Progress::note(std::string_view line) {
    if (options_.style == ProgressStyle::silent) return;
    if (options_.style == ProgressStyle::lines || finished_) {
        options_.write(fmt::format("{}\n", line));
        return;
    }
    options_.write(fmt::format("{}{}\n{}", erase_line, line, shown_));
}

void Progress::finish() {
    if (finished_) return;
    finished_ = true;
    if (options_.style == ProgressStyle::bar && !shown_.empty()) options_.write(erase_line);
    if (options_.style == ProgressStyle::lines) draw();
}

}  // namespace loam::experiments
