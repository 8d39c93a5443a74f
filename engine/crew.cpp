#include "engine/crew.hpp"

namespace loam::engine {
namespace {

constexpr int patience = 2000;  // looks, some 50 ns each: about as long as the serial parts of a step

void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/// Returns when the value is no longer `old`, asleep after a while.
void wait_for_change(const std::atomic<unsigned>& value, unsigned old) {
    for (int look = 0; look < patience; ++look) {
        if (value.load(std::memory_order_acquire) != old) return;
        pause();
    }
    value.wait(old, std::memory_order_acquire);
}

}  // namespace

Crew& Crew::operator=(const Crew& other) {
    if (this != &other) {
        dismiss();
        threads_ = other.threads_;
    }
    return *this;
}

Crew::~Crew() {
    dismiss();
}

void Crew::start() {
    for (int k = 1; k < threads_; ++k) others_.emplace_back([this] { serve(); });
}

void Crew::dismiss() {
    if (others_.empty()) return;
    leaving_ = true;
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
    for (std::thread& other : others_) other.join();
    others_.clear();
    leaving_ = false;
}

void Crew::work() {
    for (std::size_t k; (k = next_.fetch_add(1, std::memory_order_relaxed)) < tasks_;) call_(context_, k);
}

void Crew::serve() {
    for (unsigned seen = 0;;) {
        wait_for_change(round_, seen);
        ++seen;
        if (leaving_) return;
        work();
        if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
    }
}

void Crew::share(std::size_t tasks, Call call, void* context) {
    if (others_.empty()) {
        round_.store(0);  // what those that start expect
        start();
    }
    call_ = call;
    context_ = context;
    tasks_ = tasks;
    next_.store(0, std::memory_order_relaxed);
    busy_.store(static_cast<unsigned>(others_.size()), std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    round_.notify_all();
    work();
    for (unsigned left; (left = busy_.load(std::memory_order_acquire)) != 0;) wait_for_change(busy_, left);
}

}  // namespace loam::engine
