// Problems that cannot be started from are the caller's error, and the message says which value.

#include "problems.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>
#include <functional>
#include <limits>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;
using Catch::Matchers::Contains;

namespace {

struct Input {
    OdeProblem problem = decay();
    OdeOptions options;
    std::vector<double> times{1.0, 2.0};
};

std::string rejection(const std::function<void(Input&)>& spoil) {
    Input input;
    spoil(input);
    try {
        solve(input.problem, input.options, input.times);
    } catch (const rodwake::InputError& error) {
        return error.what();
    }
    return "accepted";
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST_CASE("what is not spoilt is accepted", "[integrate]") {
    CHECK(rejection([](Input&) {}) == "accepted");
}

TEST_CASE("malformed problems", "[integrate]") {
    CHECK_THAT(rejection([](Input& in) { in.problem.initial_state.clear(); }),
               Contains("initial state is empty"));
    CHECK_THAT(rejection([](Input& in) {
                   in.problem.initial_state = {1.0, nan_value};
               }),
               Contains("y[1] is nan"));
    CHECK_THAT(rejection([](Input& in) {
                   in.problem.initial_state = {infinity};
                   in.problem.component_name = [](std::size_t) { return std::string("rods[0].x"); };
               }),
               Contains("rods[0].x is inf"));
    CHECK_THAT(rejection([](Input& in) { in.problem.rhs = nullptr; }), Contains("no right-hand side"));
    CHECK_THAT(rejection([](Input& in) { in.problem.events.emplace_back().name = "gap"; }),
               Contains("'gap'"));
    CHECK_THAT(rejection([](Input& in) { in.problem.start_time = nan_value; }),
               Contains("start time is nan"));
}

TEST_CASE("malformed options", "[integrate]") {
    for (double rtol : {0.0, -1e-6, 1e-15, 0.2, infinity, nan_value})
        CHECK_THAT(rejection([&](Input& in) { in.options.rtol = rtol; }),
                   Contains("rtol is") && Contains("1e-13"));
    for (double atol : {0.0, -1.0, infinity, nan_value})
        CHECK_THAT(rejection([&](Input& in) { in.options.atol = atol; }), Contains("atol is"));
    for (double step : {-1.0, infinity, nan_value}) {
        CHECK_THAT(rejection([&](Input& in) { in.options.initial_step = step; }),
                   Contains("initial_step is"));
        CHECK_THAT(rejection([&](Input& in) { in.options.max_step = step; }), Contains("max_step is"));
    }
    CHECK_THAT(rejection([](Input& in) { in.options.max_steps = 0; }), Contains("max_steps is 0"));
    CHECK_THAT(rejection([](Input& in) { in.options.segment_steps = 0; }), Contains("segment_steps is 0"));
}

TEST_CASE("malformed output times", "[integrate]") {
    CHECK_THAT(rejection([](Input& in) { in.times.clear(); }), Contains("no output times"));
    CHECK_THAT(rejection([](Input& in) { in.times = {-1.0, 1.0}; }), Contains("output time 0 is -1, before"));
    CHECK_THAT(rejection([](Input& in) {
                   in.times = {1.0, 1.0};
               }),
               Contains("output time 1 is 1, not after"));
    CHECK_THAT(rejection([](Input& in) { in.times = {1.0, nan_value}; }), Contains("output time 1 is nan"));
    CHECK_THAT(rejection([](Input& in) { in.times = {nan_value}; }), Contains("output time 0 is nan"));
    CHECK_THAT(rejection([](Input& in) { in.times = {1.0, infinity}; }), Contains("output time 1 is inf"));
}
