#include "experiments/ensemble/ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

using Clock = std::chrono::steady_clock;

std::string one_line(std::string text) {
    constexpr std::size_t longest = 1000;
    if (text.size() > longest) {
        // Not in the middle of a UTF-8 character.
        std::size_t end = longest;
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;
        text.resize(end);
    }
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return text.empty() ? "no reason given" : text;
}

RunRecord failure(const char* reason) {
    RunRecord record;
    record.reason = reason;
    return record;
}

/// What the run gave, made fit to be stored: a failure is never mistaken for a result.
RunRecord finished_record(RunRecord record, const RunSpec& spec) {
    record.spec = spec;
    if (record.ok && !record.outputs.allFinite()) {
        record.ok = false;
        record.reason = "an output is not a finite number";
    }
    record.reason = record.ok ? "" : one_line(std::move(record.reason));
    if (!record.ok) record.outputs.resize(0);
    return record;
}

/// Makes one run; whatever goes wrong in it is its result.
RunRecord make_run(const RunFunction& run, const RunSpec& spec, const StopToken& stop) {
    RunRecord record;
    try {
        record = run(spec, stop);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        record = failure(error.what());
    } catch (...) {
        record = failure("the run threw something that is not an exception");
    }
    // A run that fails after a stop was asked for may have failed because of it: it is made again.
    if (!record.ok) stop.throw_if_requested();
    return finished_record(std::move(record), spec);
}

/// The workers and what they share with the calling thread.
class Crew {
  public:
    Crew(EnsembleStore& store, std::vector<const RunSpec*> todo, const RunFunction& run)
        : store_(store), todo_(std::move(todo)), run_(run), stop_(SignalScope::token_or(abandon_)) {}

    /// Makes all runs, or throws what ended them early. `report` gets the runs stored since its last call.
    void work(std::size_t workers, std::chrono::duration<double> interval,
              const std::function<void(const std::vector<RunRecord>&)>& report) {
        std::exception_ptr report_error;
        {
            std::vector<std::jthread> threads;
            active_ = workers;
            try {
                for (std::size_t i = 0; i < workers; ++i) threads.emplace_back([this] { worker(); });
                while (!wait(interval)) report(take_finished());
            } catch (...) {
                report_error = std::current_exception();
                abandon_ = true;
            }
        }
        if (report_error) std::rethrow_exception(report_error);
        report(take_finished());
        if (error_) std::rethrow_exception(error_);
    }

  private:
    void worker() noexcept {
        try {
            while (!stop_.stop_requested()) {
                const std::size_t next = next_.fetch_add(1);
                if (next >= todo_.size()) break;
                RunRecord record = make_run(run_, *todo_[next], stop_);
                store_.append(record);
                const std::scoped_lock lock(mutex_);
                finished_.push_back(std::move(record));
            }
        } catch (...) {
            const std::scoped_lock lock(mutex_);
            // The first error is the cause; the others are its consequences.
            if (!error_) error_ = std::current_exception();
            abandon_ = true;
        }
        const std::scoped_lock lock(mutex_);
        --active_;
        changed_.notify_one();
    }

    /// True when all workers have ended.
    bool wait(std::chrono::duration<double> interval) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, interval, [this] { return active_ == 0; });
    }

    std::vector<RunRecord> take_finished() {
        const std::scoped_lock lock(mutex_);
        return std::exchange(finished_, {});
    }

    EnsembleStore& store_;
    const std::vector<const RunSpec*> todo_;
    const RunFunction& run_;
    std::atomic<bool> abandon_{false};
    const StopToken stop_;
    std::atomic<std::size_t> next_{0};
    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t active_ = 0;
    std::vector<RunRecord> finished_;
    std::exception_ptr error_;
};

/// The specs that are not in the store; counts the others.
std::vector<const RunSpec*> find_todo(const EnsembleStore& store, std::span<const RunSpec> specs,
                                      EnsembleProgress& progress) {
    std::vector<const RunSpec*> todo;
    std::set<std::uint64_t> seen;
    for (const RunSpec& spec : specs) {
        if (!seen.insert(spec.index).second)
            throw std::invalid_argument(fmt::format("run_ensemble: two specs have the index {}", spec.index));
        const std::optional<RunRecord> stored = store.find(spec.index);
        if (!stored) {
            todo.push_back(&spec);
            continue;
        }
        if (!same_run(stored->spec, spec))
            throw lab_data::UserError(
                {.file = store.file().string(),
                 .constraint =
                     fmt::format("belongs to another campaign: run {} was made with other parameters, "
                                 "packing seed, particles or purpose",
                                 spec.index),
                 .remedy =
                     "choose another folder with --out, or delete this one's ensemble to run it again"});
        ++progress.reused;
        if (!stored->ok) ++progress.failed;
    }
    return todo;
}

std::size_t worker_count(int jobs, std::size_t runs) {
    const auto wanted = jobs > 0
                            ? static_cast<std::size_t>(jobs)
                            : static_cast<std::size_t>(std::max(1u, std::thread::hardware_concurrency()));
    return std::min(wanted, runs);
}

}  // namespace

void EnsembleOptions::validate() const {
    if (jobs < 0)
        throw std::invalid_argument(fmt::format("EnsembleOptions: jobs = {} must not be negative", jobs));
    if (!(seconds_between_progress > 0))
        throw std::invalid_argument(fmt::format(
            "EnsembleOptions: seconds_between_progress = {} must be positive", seconds_between_progress));
}

EnsembleSummary run_ensemble(EnsembleStore& store, std::span<const RunSpec> specs, const RunFunction& run,
                             const EnsembleOptions& options) {
    options.validate();
    const auto start = Clock::now();
    const SignalScope signals;
    EnsembleProgress progress{.total = specs.size()};
    std::vector<const RunSpec*> todo = find_todo(store, specs, progress);
    const std::size_t workers = worker_count(options.jobs, todo.size());

    const auto report = [&](const std::vector<RunRecord>& finished) {
        for (const RunRecord& record : finished) {
            ++progress.executed;
            if (!record.ok) ++progress.failed;
            if (options.on_record) options.on_record(record);
        }
        progress.seconds = std::chrono::duration<double>(Clock::now() - start).count();
        if (options.on_progress) options.on_progress(progress);
    };
    Crew crew(store, std::move(todo), run);
    try {
        crew.work(workers, std::chrono::duration<double>(options.seconds_between_progress), report);
    } catch (const Interrupted&) {
        store.checkpoint();
        throw;
    }
    store.checkpoint();
    if (progress.reused + progress.executed < specs.size()) throw Interrupted();

    EnsembleSummary summary;
    summary.reused = progress.reused;
    summary.executed = progress.executed;
    summary.failed = progress.failed;
    for (const RunSpec& spec : specs) summary.records.push_back(store.find(spec.index).value());
    summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return summary;
}

}  // namespace loam::experiments
