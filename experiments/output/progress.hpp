// Progress of a long job on standard error: a bar with the time left where that is a terminal, a plain line
// every few seconds where it is a file or a pipe, nothing under --quiet. Standard output is never touched: it
// carries results only.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace loam::experiments {

enum class ProgressStyle { silent, lines, bar };

/// silent if quiet, bar if standard error is a terminal (and TERM is not "dumb"), else lines.
ProgressStyle progress_style(bool quiet);

/// "45 s", "3 min 20 s", "2 h 05 min": rounded up to the second, or to the minute from an hour on.
std::string format_duration(double seconds);

struct ProgressOptions {
    ProgressStyle style = ProgressStyle::silent;
    double seconds_between_lines = 5;
    double seconds_between_redraws = 0.1;  // of the bar: no flicker
    // The three that tests replace; empty: standard error, its width, the steady clock.
    std::function<void(std::string_view)> write;
    std::function<int()> columns;
    std::function<double()> clock;
};

struct ProgressCount {
    std::size_t done = 0;    // out of the total, the reused ones included
    std::size_t reused = 0;  // done before this job began: they say nothing about its pace
    std::size_t failed = 0;
};

/// One job of `total` equal pieces. Not thread-safe: one thread reports.
class Progress {
  public:
    Progress(std::string title, std::size_t total, ProgressOptions options);
    ~Progress();  // as finish()
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// May be called as often as wished: what is shown changes at the intervals of the options.
    void update(const ProgressCount& count);

    /// A line of text that stays, above the bar if there is one. Shown in every style but silent.
    void note(std::string_view line);

    /// Takes the bar away, or writes the last line if it was not shown yet.
    void finish();

    /// Seconds until the rest is done at the mean pace of the pieces finished so far; negative: not known
    /// yet.
    double seconds_left() const;

  private:
    std::string text(bool with_bar) const;
    void draw();

    std::string title_;
    std::size_t total_;
    ProgressOptions options_;
    ProgressCount count_;
    double start_;
    double last_finish_;  // when the count last grew
    double last_shown_;   // when something was last written
    std::string shown_;   // what the terminal (or the last line) says
    bool finished_ = false;
};

}  // namespace loam::experiments
