// How Ctrl-C reaches a running simulation: a signal sets a flag, every run looks at its StopToken now and
// then and gives up by throwing Interrupted. What was finished before is kept, and the program ends with
// status 130.
#pragma once

#include <atomic>
#include <exception>

namespace loam::experiments {

/// The user (or the batch system) asked to stop. Not an error of a run, never stored as one.
class Interrupted : public std::exception {
  public:
    static constexpr int exit_status = 130;
    const char* what() const noexcept override {
        return "interrupted; every finished run is kept, the same command continues";
    }
};

/// Asks whether to stop. Cheap enough for every few hundred time steps. A copy asks the same flags; a token
/// made by default never stops. The flags must outlive it.
class StopToken {
  public:
    StopToken() = default;
    explicit StopToken(const std::atomic<bool>& flag) : first_(&flag) {}

    /// Stops when either flag is set.
    StopToken(const std::atomic<bool>& first, const std::atomic<bool>& second)
        : first_(&first), second_(&second) {}

    bool stop_requested() const noexcept { return is_set(first_) || is_set(second_); }

    /// Throws Interrupted if a stop was requested.
    void throw_if_requested() const {
        if (stop_requested()) throw Interrupted();
    }

  private:
    static bool is_set(const std::atomic<bool>* flag) noexcept {
        return flag != nullptr && flag->load(std::memory_order_relaxed);
    }
    const std::atomic<bool>* first_ = nullptr;
    const std::atomic<bool>* second_ = nullptr;
};

/// While one of these lives, SIGINT and SIGTERM set the process's stop flag instead of ending it; a second
/// signal of the same kind ends it at once. May be nested: the outermost one installs the handlers (and
/// clears the flag), and puts the former ones back at its end. Made and destroyed by one thread.
class SignalScope {
  public:
    SignalScope();
    ~SignalScope();
    SignalScope(const SignalScope&) = delete;
    SignalScope& operator=(const SignalScope&) = delete;

    /// Stops when a signal has come (or, the second, when `flag` is set).
    static StopToken token();
    static StopToken token_or(const std::atomic<bool>& flag);
};

}  // namespace loam::experiments
