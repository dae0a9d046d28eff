#pragma once
// Tasks over threads. Which thread does which task changes nothing but the time taken.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <type_traits>
#include <vector>

namespace rodwake {

/// As many of `threads` as have at least `least` of the work each; one at least.
std::size_t threads_for(std::size_t work, std::size_t least, std::size_t threads);

/// Threads that stay together through very many short loops. They start with the first loop that is shared.
/// Between loops they wait awake for a while that is about the price of a sleep, and asleep after that. A
/// loop ends when its tasks are done: nobody waits for a thread that has not begun by then, which beside
/// other programs may be long.
class ThreadPool {
public:
    /// `threads` in all, the caller among them, or as many as the system starts; 1: no thread is started.
    explicit ThreadPool(std::size_t threads) : threads_(threads) {}
    ~ThreadPool();
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;
    ThreadPool(ThreadPool&&) = delete;
    ThreadPool& operator=(ThreadPool&&) = delete;

    /// Starts the threads now and says how many there are, the caller among them.
    std::size_t started();

    /// Calls task(i) once for each i in [0, count) and returns when all are done. Which thread does which is
    /// left open, but in every loop the caller begins at the first and the others at the last, so that data
    /// tends to stay in a processor's cache. Tasks must not throw. Called while it runs, by a task or by
    /// another thread: that caller does its tasks alone.
    template<class Task>
    void run(std::size_t count, Task&& task) {
        const Call call = [](void* context, std::size_t i) {
            (*static_cast<std::remove_reference_t<Task>*>(context))(i);
        };
        if (threads_ < 2 || count < 2 || !share(count, call, &task))
            for (std::size_t i = 0; i < count; ++i)
                task(i);
    }

private:
    using Call = void (*)(void*, std::size_t);
    bool share(std::size_t count, Call call, void* context);
    void start();
    void work();
    bool opened(std::uint32_t seen) const;
    void take_tasks(std::uint64_t one);
    void leave();

    std::size_t threads_;
    std::vector<std::thread> workers_;
    std::atomic_flag in_use_;
    // of a round; written while nobody is inside
    Call call_ = nullptr;
    void* context_ = nullptr;
    std::size_t count_ = 0;
    static constexpr std::size_t line = 64; // of the cache: waiting for one must not slow down another
    alignas(line) std::atomic<std::uint64_t> taken_{0}; ///< this and the gate: see parallel.cpp
    alignas(line) std::atomic<std::uint32_t> gate_{0};
    std::atomic<std::uint32_t> all_left_{0};
    std::atomic<bool> ending_{false};
};
using Team [[deprecated("it is ThreadPool")]] = ThreadPool;

/// Calls task(i) once for each i in [0, count) by the team, or on up to `threads` threads. If tasks throw,
/// the exception of the lowest index is rethrown after all have ended.
void parallel_for(std::size_t count, ThreadPool& team, const std::function<void(std::size_t)>& task);
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task);

} // namespace rodwake
