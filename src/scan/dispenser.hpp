#pragma once
// The points of one call of an executor, handed out in chunks to whoever asks.

#include "chunk_size.hpp"
#include "rodwake/scan/execute.hpp"

#include <mutex>

namespace rodwake::scan {

class Dispenser {
public:
    Dispenser(std::span<const Point> points, const Take& take, std::size_t workers,
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
        for (const Result& one : results)
            seconds += one.seconds;
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
void work(Dispenser& dispenser, const Evaluate& evaluate);

} // namespace rodwake::scan
