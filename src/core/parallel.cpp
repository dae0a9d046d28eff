#include "rodwake/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace rodwake {

namespace {

// The gate of a team: the lowest bit is set while a round takes in workers, then come 15 bits for how many
// are inside, then the number of the round, which may wrap.
//
// A worker comes in by one exchange of the whole gate, from open with n inside to open with n + 1, so never
// into a closed round. The caller writes what a round needs before it opens the gate and again only after it
// has closed it and all who were inside have left: what workers read inside does not change. Who did not come
// in sees the next round and is not waited for.
constexpr std::uint32_t open = 1, one_inside = 2, one_round = 1U << 16;

// Tasks that are taken, of a round: the lower half of a number counts those from the first on, the upper half
// those from the last on. Who adds one and finds that not all were taken has got a task.
constexpr std::uint64_t from_first = 1, from_last = std::uint64_t{1} << 32;

std::uint32_t inside(std::uint32_t gate) { return gate % one_round / one_inside; }
std::uint32_t round_of(std::uint32_t gate) { return gate / one_round; }

/// To send a thread to sleep and wake it takes 10 to 50 us, so a longer watch saves nothing; and beside
/// another program the processor may be wanted.
constexpr auto watch = std::chrono::microseconds(50);

template<class Done>
void wait_until(const Done& done, const std::atomic<std::uint32_t>& changes) {
    using Clock = std::chrono::steady_clock;
    for (const auto end = Clock::now() + watch; Clock::now() < end;)
        for (int k = 0; k < 16; ++k) {
            if (done())
                return;
#if defined(__x86_64__)
            __builtin_ia32_pause();
#endif
        }
    for (std::uint32_t seen = changes; !done(); seen = changes)
        changes.wait(seen);
}

struct Claim {
    std::atomic_flag& flag;
    ~Claim() { flag.clear(); }
};

} // namespace

std::size_t threads_for(std::size_t work, std::size_t least, std::size_t threads) {
    return std::clamp<std::size_t>(work / least, 1, std::max<std::size_t>(threads, 1));
}

ThreadPool::~ThreadPool() {
    ending_ = true;
    gate_ += one_round;
    gate_.notify_all();
    for (std::thread& worker : workers_)
        worker.join();
}

/// Where the system has no more threads, those that are there do it.
void ThreadPool::start() {
    try {
        while (workers_.size() + 1 < threads_)
            workers_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
        threads_ = workers_.size() + 1;
    }
}

std::size_t ThreadPool::started() {
    start();
    return threads_;
}

void ThreadPool::take_tasks(std::uint64_t one) {
    for (;;) {
        const std::uint64_t taken = taken_.fetch_add(one), first = taken % from_last,
                            last = taken / from_last;
        if (first + last >= count_)
            return;
        call_(context_, one == from_first ? first : count_ - 1 - last);
    }
}

/// False if it is in use, or has too many tasks to count.
bool ThreadPool::share(std::size_t count, Call call, void* context) {
    if (count >= from_last / 2 || in_use_.test_and_set())
        return false;
    const Claim claim{in_use_};
    start();
    call_ = call;
    context_ = context;
    count_ = count;
    taken_ = 0;
    all_left_ = 0;
    gate_ = (round_of(gate_) + 1) * one_round + open;
    gate_.notify_all();
    take_tasks(from_first);
    if (inside(gate_.fetch_sub(open)) > 0)
        wait_until([this] { return all_left_ == 1; }, all_left_);
    return true;
}

/// Whether there is a round to come into, or the end.
bool ThreadPool::opened(std::uint32_t seen) const {
    const std::uint32_t gate = gate_;
    return ending_ || (gate % 2 == open && round_of(gate) != seen);
}

void ThreadPool::work() {
    for (std::uint32_t seen = 0;;) {
        wait_until([&] { return opened(seen); }, gate_);
        if (ending_)
            return;
        std::uint32_t gate = gate_;
        if (gate % 2 != open || !gate_.compare_exchange_strong(gate, gate + one_inside))
            continue; // it closed, or another came in
        seen = round_of(gate);
        take_tasks(from_last);
        leave();
    }
}

/// The last one out of a closed gate tells the caller, who waits.
void ThreadPool::leave() {
    const std::uint32_t gate = gate_.fetch_sub(one_inside);
    if (gate % 2 == open || inside(gate) > 1)
        return;
    all_left_ = 1;
    all_left_.notify_one();
}

void parallel_for(std::size_t count, ThreadPool& team, const std::function<void(std::size_t)>& task) {
    std::vector<std::exception_ptr> failures(count);
    team.run(count, [&](std::size_t i) {
        try {
            task(i);
        } catch (...) {
            failures[i] = std::current_exception();
        }
    });
    for (const std::exception_ptr& failure : failures)
        if (failure)
            std::rethrow_exception(failure);
}

void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task) {
    ThreadPool team(std::min(threads, count));
    parallel_for(count, team, task);
}

} // namespace rodwake
