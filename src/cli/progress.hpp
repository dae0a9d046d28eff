#pragma once
// Progress of a stage: a line that redraws itself on a terminal, a plain line now and then elsewhere.

#include "log.hpp"

#include <chrono>
#include <string>

namespace rodwake::cli {

class Progress {
public:
    /// `end`: value at which the work is done; `unit` of the value, for the rate.
    Progress(Logger logger, bool quiet, std::string what, double end, std::string unit);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    Progress(Progress&&) = delete;
    Progress& operator=(Progress&&) = delete;

    /// Cheap enough for every step: looks at the clock, prints rarely.
    void update(double value);

private:
    using Clock = std::chrono::steady_clock;
    void print(double value, double seconds);

    Logger logger_;
    std::string what_, unit_;
    double end_, begin_ = 0.0; ///< value at the end, and at the first update
    bool begun_ = false;
    bool quiet_, terminal_, drawn_ = false;
    Clock::time_point start_, next_;
};

} // namespace rodwake::cli
