#pragma once
// The points of one call of an executor, handed out in chunks to whoever asks.

#include "rodwake/scan/mpi.hpp"

#include <algorithm>
#include <cstddef>
#include <mutex>

namespace rodwake::scan {

/// How many points to hand out at once: about 10 ms of work by what a point has cost so far, and at the end
/// not so many that others wait.
class ChunkSize {
public:
    explicit ChunkSize(std::size_t workers) : workers_(std::max<std::size_t>(workers, 1)) {}

    void learn(std::size_t points, double seconds) {
        points_ += static_cast<double>(points);
        seconds_ += seconds;
    }

    std::size_t next(std::size_t left) const {
        if (points_ == 0.0) // not known yet
            return std::min<std::size_t>(left, 1);
        const double a_second = points_ / std::max(seconds_, 1e-9);
        const double share = static_cast<double>(left) / (2.0 * static_cast<double>(workers_));
        const double wanted = std::clamp(share, std::min(least * a_second, enough), target * a_second);
        return std::clamp<std::size_t>(static_cast<std::size_t>(std::min(wanted, 1e9)), 1,
                                       std::min<std::size_t>(left, most));
    }

private:
    static constexpr double target = 0.01; // s
    static constexpr double least = 2e-4;  // s: less does not repay handing it out,
    static constexpr double enough = 16.0; // but so many points fill the lanes of pairs
    static constexpr std::size_t most = 4096;
    std::size_t workers_;
    double points_ = 0.0, seconds_ = 0.0;
};

class WorkQueue {
public:
    WorkQueue(std::span<const Point> points, const Take& take, std::size_t workers,
              const std::function<bool()>& stop)
        : points_(points), take_(take), stop_(stop), size_(workers) {}

    /// Empty: none left, or stopped.
    std::span<const Point> next() {
        const std::lock_guard lock(mutex_);
        if (next_ == points_.size() || stopped_ || (stopped_ = stop_ && stop_()))
            return {};
        const std::size_t first = next_;
        next_ += size_.next(points_.size() - next_);
        return points_.subspan(first, next_ - first);
    }

    /// Results of a chunk; those of points that were stopped are dropped.
    void take(std::vector<Result>& results) {
        const std::lock_guard lock(mutex_);
        double seconds = 0.0;
        for (const Result& result : results)
            seconds += result.seconds;
        size_.learn(results.size(), seconds);
        if (std::erase_if(results, [](const Result& r) { return r.status == Status::stopped; }) > 0)
            stopped_ = true;
        try {
            take_(results);
        } catch (...) { // the disk is full: nobody need go on
            stopped_ = true;
            throw;
        }
    }

    void stop() {
        const std::lock_guard lock(mutex_);
        stopped_ = true;
    }
    bool stopped() const { return stopped_; }

private:
    std::mutex mutex_;
    std::span<const Point> points_;
    const Take& take_;
    const std::function<bool()>& stop_;
    ChunkSize size_;
    std::size_t next_ = 0;
    bool stopped_ = false;
};

/// Evaluates chunks until there are none.
void work(WorkQueue& queue, const Evaluate& evaluate);

} // namespace rodwake::scan
