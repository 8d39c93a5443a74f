// Threads that work on the tasks of one step, thousands of times a second. OpenMP's team would wait for each
// other without end, which on a machine that has other work makes a step ten times as long; these sleep after
// a short while.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace loam::engine {

class Crew {
  public:
    /// `threads` >= 1, of which the caller's is one: others are started at the first run() that can use them.
    explicit Crew(int threads = 1) : threads_(threads) {}
    /// A copy has threads of its own.
    Crew(const Crew& other) : Crew(other.threads_) {}
    Crew& operator=(const Crew& other);
    ~Crew();

    int threads() const { return threads_; }

    /// Calls task(k) for k in 0..tasks-1, each once, in any order and at once; returns when all are done.
    /// Tasks must not throw.
    template <class Task>
    void run(std::size_t tasks, Task&& task) {
        if (threads_ == 1 || tasks == 1) {
            for (std::size_t k = 0; k < tasks; ++k) task(k);
            return;
        }
        share(
            tasks, [](void* context, std::size_t k) { (*static_cast<Task*>(context))(k); },
            const_cast<void*>(static_cast<const void*>(&task)));
    }

  private:
    using Call = void (*)(void* context, std::size_t k);
    void share(std::size_t tasks, Call call, void* context);
    void start();
    void dismiss();
    void work();
    void serve();

    int threads_;
    std::vector<std::thread> others_;
    Call call_ = nullptr;
    void* context_ = nullptr;
    std::size_t tasks_ = 0;
    bool leaving_ = false;
    alignas(64) std::atomic<std::size_t> next_{0};
    alignas(64) std::atomic<unsigned> round_{0};  // counts the calls of share()
    alignas(64) std::atomic<unsigned> busy_{0};   // others that have not finished this round
};

}  // namespace loam::engine
