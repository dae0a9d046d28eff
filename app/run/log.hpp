#pragma once
// Where the messages of a run go (to the caller, and to log.txt of the run folder), and how far it is.

#include "rodwake/app/run_context.hpp"

#include <spdlog/logger.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace rodwake::app {

using Logger = std::shared_ptr<spdlog::logger>;

/// Throws RunError if the file cannot be opened.
Logger make_logger(const RunContext& context, const std::filesystem::path& run_log);

/// For ranks, whose messages come home with their results.
Logger make_silent_logger();

/// Progress of one task, reported by one thread.
class Progress {
public:
    /// `end`: value at which the work is done; `unit` of the value, for the rate.
    Progress(const RunContext& context, std::string what, double end, std::string unit)
        : tell_(context.progress), what_(std::move(what)), unit_(std::move(unit)), end_(end) {}

    /// Work whose end is seen only on the way.
    void update(double value, double end) {
        end_ = end;
        update(value);
    }

    void update(double value) {
        if (!tell_)
            return;
        if (!begun_)
            begin_ = value;
        begun_ = true;
        tell_({what_, begin_, value, end_, unit_});
    }

private:
    std::function<void(const ProgressReport&)> tell_;
    std::string what_, unit_;
    double end_, begin_ = 0.0; ///< value at the end, and at the first update
    bool begun_ = false;
};

/// Progress of several tasks together. A thread that finds another one reporting does not wait.
class SharedProgress {
public:
    SharedProgress(const RunContext& context, std::string what, std::size_t tasks, double end,
                   std::string unit)
        : done_(tasks, 0.0), progress_(context, std::move(what), end, std::move(unit)) {}

    /// `value` of this task. False if nothing was reported.
    bool update(std::size_t task, double value) {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock)
            return false;
        sum_ += value - done_[task];
        done_[task] = value;
        progress_.update(sum_);
        return true;
    }

private:
    std::vector<double> done_;
    double sum_ = 0.0;
    Progress progress_;
    std::mutex mutex_;
};

} // namespace rodwake::app
