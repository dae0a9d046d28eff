#include "rodwake/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace rodwake {

void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task) {
    std::vector<std::exception_ptr> failures(count);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < count; i = next++)
            try {
                task(i);
            } catch (...) {
                failures[i] = std::current_exception();
            }
    };
    {
        std::vector<std::jthread> helpers;
        for (std::size_t k = 1; k < std::min(threads, count); ++k)
            helpers.emplace_back(work);
        work();
    }
    for (const std::exception_ptr& failure : failures)
        if (failure)
            std::rethrow_exception(failure);
}

namespace {

/// Spins a while before it gives the processor away: loops follow each other within microseconds.
template<class Done>
void wait_until(const Done& done) {
    for (int spins = 0; !done(); ++spins)
        if (spins > 2000)
            std::this_thread::yield();
}

} // namespace

Team::Team(std::size_t threads) {
    for (std::size_t i = 1; i < threads; ++i)
        workers_.emplace_back([this] { work(); });
}

Team::~Team() {
    leave_ = true;
    ++round_;
    for (std::thread& worker : workers_)
        worker.join();
}

void Team::take_tasks() {
    for (std::size_t i = next_++; i < count_; i = next_++)
        call_(context_, i);
}

void Team::share(std::size_t count, Call call, void* context) {
    call_ = call;
    context_ = context;
    count_ = count;
    next_ = 0;
    busy_ = workers_.size();
    ++round_; // releases what was written above to the workers
    take_tasks();
    wait_until([this] { return busy_ == 0; });
}

void Team::work() {
    for (std::size_t seen = 0;;) {
        wait_until([&] { return round_ != seen; });
        seen = round_;
        if (leave_)
            return;
        take_tasks();
        --busy_;
    }
}

} // namespace rodwake
