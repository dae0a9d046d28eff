// What a provenance record says about the program is filled in.

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/stopwatch.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

using rodwake::seconds_of;
using rodwake::Stopwatch;

TEST_CASE("Version, commit, compiler and libraries are known") {
    const rodwake::BuildInfo build = rodwake::build_info();
    CHECK(std::regex_match(build.version, std::regex(R"(\d+\.\d+\.\d+)")));
    CHECK(std::regex_match(build.git, std::regex("[0-9a-f]{7,40}(-dirty)?|unknown")));
    CHECK(std::regex_search(build.compiler, std::regex(R"(^\S+ \d+\.)")));
    CHECK_FALSE(build.flags.empty());
    for (const char* name :
         {"SUNDIALS", "Eigen", "Boost", "HDF5", "toml++", "CLI11", "fmt", "spdlog", "nlohmann-json"}) {
        CAPTURE(name);
        const auto found =
            std::ranges::find(build.libraries, name, &std::pair<std::string, std::string>::first);
        REQUIRE(found != build.libraries.end());
        CHECK(std::regex_search(found->second, std::regex(R"(^\d+\.\d+)")));
    }
}

TEST_CASE("The CPU has a name") { CHECK_FALSE(rodwake::cpu_model().empty()); }

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
