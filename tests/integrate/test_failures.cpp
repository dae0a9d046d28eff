// What a failed solve says, and what it keeps.

#include "problems.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <limits>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;
using Catch::Matchers::Contains;

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
const std::vector<double> to_two{0.0, 0.1, 0.2, 2.0};

Solution run(const OdeProblem& problem, Method method) {
    return solve(problem, options_for(method, 1e-6), to_two);
}

/// y' = -y with `after(ydot)` applied from t = 0.5 on.
template<class After>
OdeProblem decay_until_half(After after) {
    OdeProblem problem = decay();
    problem.rhs = [after](double t, State y, std::span<double> ydot) {
        ydot[0] = -y[0];
        if (t > 0.5)
            after(ydot);
    };
    problem.component_name = [](std::size_t i) { return "rods[" + std::to_string(i) + "].theta"; };
    return problem;
}

void check_kept_first_outputs(const Solution& solution) {
    CHECK(solution.times == std::vector<double>{0.0, 0.1, 0.2});
    CHECK(solution.final_time > 0.2);
    CHECK(solution.final_time < 2.0);
    CHECK(solution.status.reached == solution.final_time);
    CHECK(solution.status.wanted == 2.0);
    CHECK(std::abs(solution.final_state[0] - std::exp(-solution.final_time)) < 1e-4); // 100 rtol
}

} // namespace

TEST_CASE("an exception in the right-hand side ends the solve with its text", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const Solution solution =
        run(decay_until_half([](std::span<double>) { throw std::runtime_error("rods touch"); }), method);
    INFO(to_string(method));
    CHECK(solution.status.termination == Termination::failed);
    check_kept_first_outputs(solution);
    CHECK_THAT(solution.status.cause, Contains("rods touch"));
    CHECK_THAT(solution.status.message(),
               Contains("rods touch") && Contains("RHSFUNC_FAIL") && Contains(" of 2 "));
}

TEST_CASE("an exception that is no std::exception is still an ending", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const Solution solution = run(decay_until_half([](std::span<double>) { throw 42; }), method);
    CHECK(solution.status.termination == Termination::failed);
    CHECK_THAT(solution.status.cause, Contains("not derived from std::exception"));
}

TEST_CASE("a right-hand side that stays NaN fails and names the component", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const Solution solution =
        run(decay_until_half([](std::span<double> ydot) { ydot[0] = nan_value; }), method);
    INFO(solution.status.message());
    CHECK(solution.status.termination == Termination::failed);
    check_kept_first_outputs(solution);
    CHECK(solution.final_time <= 0.5);
    CHECK(solution.final_time > 0.49); // shorter steps were tried up to the edge
    CHECK_THAT(solution.status.message(), Contains("rods[0].theta was nan"));
    CHECK(solution.status.worst.empty());
}

TEST_CASE("a right-hand side that is NaN only out of reach costs a shorter step", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeProblem problem;
    problem.initial_state = {1.0};
    problem.rhs = [](double, State y, std::span<double> ydot) { ydot[0] = -std::sqrt(y[0] - 0.5); };
    OdeOptions options = options_for(method, 1e-6);
    options.initial_step = 1.4;           // a first step to y < 0.5, where the root is NaN
    const std::vector<double> times{1.0}; // sqrt(y - 0.5) = sqrt(0.5) - t / 2
    const Solution solution = solve(problem, options, times);
    REQUIRE(solution.status.termination == Termination::reached_end);
    const double root = std::sqrt(0.5) - 0.5;
    CHECK(std::abs(solution.final_state[0] - (0.5 + root * root)) < 1e-4); // 100 rtol
}

TEST_CASE("NaN at the start", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeProblem problem = decay();
    problem.rhs = [](double, State, std::span<double> ydot) { ydot[0] = nan_value; };
    const Solution solution = run(problem, method);
    CHECK(solution.status.termination == Termination::failed);
    CHECK(solution.final_time == 0.0);
    CHECK_THAT(solution.status.message(), Contains("y[0] was nan at t=0"));
}

TEST_CASE("a Jacobian that throws, or is NaN", "[integrate]") {
    OdeProblem problem = decay();
    problem.jacobian = [](double, State, Eigen::Ref<Eigen::MatrixXd>) {
        throw std::runtime_error("no Jacobian");
    };
    CHECK_THAT(run(problem, Method::bdf).status.message(),
               Contains("the Jacobian threw") && Contains("no Jacobian"));
    problem.jacobian = [](double, State, Eigen::Ref<Eigen::MatrixXd> j) { j(0, 0) = nan_value; };
    CHECK_THAT(run(problem, Method::bdf).status.message(),
               Contains("the Jacobian entry d(y[0])'/d(y[0]) was nan"));
}

TEST_CASE("an event that throws, or is NaN", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const double from = GENERATE(-1.0, 0.5); // at the start, and later
    OdeProblem problem = decay();
    problem.events = {{"gap", [from](double t, State) -> double {
                           if (t > from)
                               throw std::runtime_error("no gap");
                           return 1.0;
                       }}};
    Solution solution = run(problem, method);
    CHECK(solution.status.termination == Termination::failed);
    CHECK_THAT(solution.status.message(),
               Contains("event 'gap' threw") && Contains("no gap") && Contains("RTFUNC_FAIL"));
    CHECK(solution.final_time <= 0.5);
    problem.events[0].value = [from](double t, State) { return t > from ? nan_value : 1.0; };
    CHECK_THAT(run(problem, method).status.message(), Contains("event 'gap' was nan"));
}

TEST_CASE("the step ceiling is a failure that keeps the solution", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeOptions options = options_for(method, 1e-8);
    options.max_steps = 165;
    options.segment_steps = 50; // the ceiling counts across segments
    const std::vector<double> times = evenly(0.0, 1000.0, 100000);
    const Solution solution = solve(oscillator(), options, times);
    CHECK(solution.status.termination == Termination::failed);
    CHECK(solution.statistics.steps == 165);
    CHECK_THAT(solution.status.flag, Contains("TOO_MUCH_WORK"));
    CHECK_THAT(solution.status.message(), Contains("raise max_steps"));
    REQUIRE(solution.times.size() > 1);
    CHECK(solution.times.back() <= solution.final_time);
    CHECK(times[solution.times.size()] > solution.final_time);
    CHECK_FALSE(solution.status.worst.empty());
}

TEST_CASE("a singularity ends in a failure that names the worst component", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    OdeProblem problem; // y1 = 1 / (1 - t), y0 nearly at rest
    problem.initial_state = {1.0, 1.0};
    problem.rhs = [](double, State y, std::span<double> ydot) {
        ydot[0] = -1e-3 * y[0];
        ydot[1] = y[1] * y[1];
    };
    problem.component_name = [](std::size_t i) { return i == 1 ? "rods[3].x" : "rods[2].x"; };
    OdeOptions options = options_for(method, 1e-6);
    options.max_steps = 100000;
    const Solution solution = solve(problem, options, to_two);
    INFO(solution.status.message());
    CHECK(solution.status.termination == Termination::failed);
    CHECK(std::abs(solution.final_time - 1.0) <
          1e-3); // where 1 / (1 - t) is singular, shifted by up to 1000 rtol
    CHECK_FALSE(solution.status.cause.empty());
    CHECK_FALSE(solution.status.advice.empty());
    CHECK_THAT(solution.status.message(), !Contains("rods[2].x"));
    if (!solution.status.worst.empty())
        CHECK(solution.status.worst[0].name == "rods[3].x");
}

TEST_CASE("a jump that no step can cross is an error test failure with sizes", "[integrate]") {
    // A right-hand side that changes by 1e12 at random at every call is no function of time at all.
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    OdeProblem problem = decay();
    problem.initial_state = {1.0, 1.0};
    problem.jacobian = nullptr;
    double sign = 1.0;
    problem.rhs = [&](double t, State y, std::span<double> ydot) {
        ydot[0] = -y[0];
        ydot[1] = t > 0.5 ? (sign = -sign) * 1e12 : -y[1];
    };
    const Solution solution = run(problem, method);
    INFO(solution.status.message());
    CHECK(solution.status.termination == Termination::failed);
    CHECK(solution.times.size() == 3);
    REQUIRE_FALSE(solution.status.worst.empty());
    CHECK(solution.status.worst[0].name == "y[1]");
    CHECK(solution.status.step < 1e-3);
    CHECK(solution.status.step > 0.0);
}

TEST_CASE("interruption keeps what there is", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeOptions options = options_for(method, 1e-6);
    int polls = 0;
    options.stop_requested = [&] { return ++polls == 60; };
    const std::vector<double> times = evenly(0.0, 100.0, 1000);
    const Solution solution = solve(oscillator(), options, times);
    CHECK(solution.status.termination == Termination::interrupted);
    CHECK(solution.status.ok());
    CHECK(solution.statistics.steps == 60);
    CHECK(solution.times.size() > 1);
    CHECK(solution.final_time < 100.0);
    CHECK_THAT(solution.status.message(), Contains("interrupted at t=") && Contains(" of 100"));
}

TEST_CASE("an exception of the caller's own hooks reaches the caller", "[integrate]") {
    OdeOptions options = options_for(Method::adams, 1e-6);
    options.on_step = [](const Step&) { throw std::runtime_error("disk full"); };
    const std::vector<double> times{1.0};
    CHECK_THROWS_WITH(solve(oscillator(), options, times), "disk full");
}

// --- Problems that cannot be started from are the caller's error, and the message says which value

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
