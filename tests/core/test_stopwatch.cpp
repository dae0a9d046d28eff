#include "rodwake/core/stopwatch.hpp"

#include <catch2/catch.hpp>

using rodwake::seconds_of;
using rodwake::Stopwatch;

namespace {

/// Work that takes so long by the clock it is timed with.
struct Busy {
    double seconds;
    long* calls;

    void operator()() const {
        ++*calls;
        const Stopwatch watch;
        while (watch.seconds() < seconds) {
        }
    }
};

} // namespace

TEST_CASE("a call is timed to no less than it takes, within the budget") {
    long calls = 0;
    CHECK(seconds_of(Busy{1e-3, &calls}, 0.02) >= 1e-3);
    CHECK(calls >= 5);
    CHECK(calls <= 11); // one to begin with, then five rounds of at most two: 0.004 s are meant for each
}

TEST_CASE("a call that takes longer than the budget is made once") {
    long calls = 0;
    CHECK(seconds_of(Busy{2e-3, &calls}, 1e-3) >= 2e-3);
    CHECK(calls == 1);
}

TEST_CASE("what takes next to nothing is called often enough to be seen") {
    volatile long calls = 0;
    CHECK(seconds_of([&] { calls = calls + 1; }, 5e-3) > 0.0);
    CHECK(calls > 100);
}
