#include "progress.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>

namespace rodwake::cli {

namespace {

using namespace std::chrono_literals;
constexpr std::chrono::milliseconds terminal_interval = 200ms, plain_interval = 10s;

} // namespace

Progress::Progress(Logger logger, bool quiet, std::string what, double end, std::string unit)
    : logger_(std::move(logger)), what_(std::move(what)), unit_(std::move(unit)), end_(end), quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1), start_(Clock::now()),
      next_(start_ + (terminal_ ? terminal_interval : plain_interval)) {}

Progress::~Progress() {
    if (drawn_)
        fmt::print(stderr, "\r\033[K");
}

void Progress::update(double value) {
    if (quiet_)
        return;
    if (!begun_) // what an earlier command did took this one no time
        begin_ = value;
    begun_ = true;
    const auto now = Clock::now();
    if (now < next_)
        return;
    next_ = now + (terminal_ ? terminal_interval : plain_interval);
    print(value, std::chrono::duration<double>(now - start_).count());
}

void Progress::print(double value, double seconds) {
    const double rate = (value - begin_) / seconds, left = rate > 0.0 ? (end_ - value) / rate : 0.0;
    const std::string line = fmt::format("{}: {:.4g} of {:.4g} {} ({:.0f} %), {:.3g} {}/s, {:.0f} s left",
                                         what_, value, end_, unit_, 100.0 * value / end_, rate, unit_, left);
    if (terminal_) {
        fmt::print(stderr, "\r\033[K{}", line);
        std::fflush(stderr);
        drawn_ = true;
    } else {
        logger_->info(line);
    }
}

} // namespace rodwake::cli
