#pragma once
// Tasks over threads. Which thread does which task changes nothing but the time taken.

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace rodwake {

/// Calls task(i) once for each i in [0, count) on up to `threads` threads. If tasks throw, the exception of
/// the lowest index is rethrown after all have ended.
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task);

/// Threads that stay together through very many short loops (a loop a microsecond apart is worth it).
class Team {
public:
    /// `threads` in all, the caller among them; 1: no thread is started.
    explicit Team(std::size_t threads);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;
    Team(Team&&) = delete;
    Team& operator=(Team&&) = delete;

    /// Calls task(i) once for each i in [0, count) and returns when all are done. Which thread does which is
    /// left open. Tasks must not throw.
    template<class Task>
    void run(std::size_t count, Task&& task) {
        if (workers_.empty() || count < 2) {
            for (std::size_t i = 0; i < count; ++i)
                task(i);
            return;
        }
        share(
            count,
            [](void* context, std::size_t i) { (*static_cast<std::remove_reference_t<Task>*>(context))(i); },
            &task);
    }

private:
    using Call = void (*)(void*, std::size_t);
    void share(std::size_t count, Call call, void* context);
    void work();
    void take_tasks();

    Call call_ = nullptr;
    void* context_ = nullptr;
    std::size_t count_ = 0;
    std::atomic<std::size_t> next_{0}, busy_{0};
    std::atomic<std::size_t> round_{0};
    std::atomic<bool> leave_{false};
    std::vector<std::thread> workers_;
};

} // namespace rodwake
