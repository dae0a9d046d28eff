#pragma once
// How long work takes on this machine, in CPU seconds of the calling thread: what other programs do meanwhile
// is no cost of the work. Work that hands tasks to other threads is timed by its own thread's share only.

#include <algorithm>
#include <ctime>

namespace rodwake {

/// Runs from its construction.
class Stopwatch {
public:
    double seconds() const { return now() - start_; }

private:
    static double now() {
        std::timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }

    double start_ = now();
};

/// Seconds of a call: the smallest mean of five rounds that take about `budget` seconds together, each of so
/// many calls that reading the clock does not count. The smallest, since whatever disturbs adds. One call
/// comes before them, to fill caches; where it takes longer than the budget it is the only one.
template<class Call>
double seconds_of(const Call& call, double budget) {
    constexpr int rounds = 5;
    const auto round = [&](long calls) {
        const Stopwatch watch;
        for (long i = 0; i < calls; ++i)
            call();
        return watch.seconds() / static_cast<double>(calls);
    };
    const double first = round(1);
    if (first > budget)
        return first;
    double least = first;
    long calls = 1; // grown until a round is long enough: the first call tells little of the others
    while (least * static_cast<double>(calls) < 0.5 * budget / rounds && calls < 1L << 40) {
        calls *= 2;
        least = round(calls);
    }
    for (int i = 1; i < rounds; ++i)
        least = std::min(least, round(calls));
    return least;
}

} // namespace rodwake
