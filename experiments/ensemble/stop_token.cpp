#include "experiments/ensemble/stop_token.hpp"

#include <array>
#include <csignal>

namespace loam::experiments {
namespace {

std::atomic<bool> signalled{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

constexpr std::array<int, 3> signals{SIGINT, SIGTERM, SIGXFSZ};
std::array<struct sigaction, signals.size()> former;
int depth = 0;

void note_signal(int) {
    signalled.store(true, std::memory_order_relaxed);
}

}  // namespace

SignalScope::SignalScope() {
    if (depth++ > 0) return;
    signalled = false;
    struct sigaction action {};
    action.sa_handler = note_signal;
    // RESETHAND: the second Ctrl-C ends a program that does not come to an end by itself. Nothing is lost,
    // finished runs are on the disk already. A shell starts background jobs with SIGINT ignored; it is
    // handled even so, because whoever sends it by name means it.
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigemptyset(&action.sa_mask);
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    for (std::size_t i = 0; i < signals.size(); ++i)
        sigaction(signals[i], signals[i] == SIGXFSZ ? &ignore : &action, &former[i]);
}

SignalScope::~SignalScope() {
    if (--depth > 0) return;
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &former[i], nullptr);
}

StopToken SignalScope::token() {
    return StopToken(signalled);
}

StopToken SignalScope::token_or(const std::atomic<bool>& flag) {
    return StopToken(signalled, flag);
}

}  // namespace loam::experiments
