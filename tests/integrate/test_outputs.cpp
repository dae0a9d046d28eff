// Output times: exactly those asked for, wherever they fall.

#include "problems.hpp"

#include <catch2/catch.hpp>
#include <numbers>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

TEST_CASE("outputs are at the requested times, however dense", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const int intervals = GENERATE(1, 7, 3000); // 3000: many within one step
    const std::vector<double> times = evenly(0.0, 3.0, intervals);
    const Solution solution = solve(oscillator(), options_for(method, 1e-9), times);
    INFO(to_string(method));
    REQUIRE(solution.times == times);
    REQUIRE(solution.states.size() == times.size());
    CHECK(solution.final_time == 3.0);
    CHECK(solution.final_state == solution.states.back());
    CHECK(solution.states[0] == std::vector<double>{1.0, 0.0});
    double worst = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k)
        worst = std::max(worst, std::abs(solution.states[k][0] - std::cos(times[k])));
    CHECK(worst < 3e-7); // 300 rtol: global over local error of some 150 steps
    if (intervals == 3000)
        CHECK(solution.statistics.steps < 1000); // outputs do not force steps
}

TEST_CASE("the steps do not depend on the outputs asked for", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const std::vector<double> sparse{3.0}, dense = evenly(0.0, 3.0, 500);
    const Solution a = solve(oscillator(), options_for(method, 1e-9), sparse);
    const Solution b = solve(oscillator(), options_for(method, 1e-9), dense);
    CHECK(a.final_state == b.final_state);
    CHECK(a.statistics.steps == b.statistics.steps);
}

TEST_CASE("inside explicit steps the solution is as good as at their ends, and costs as much for any number "
          "of times",
          "[integrate]") {
    // one dimension more than the small stepper takes goes through ARKODE
    const std::size_t copies = GENERATE(1U, 20U);
    OdeProblem problem = oscillator();
    for (std::size_t k = 1; k < copies; ++k)
        problem.initial_state.insert(problem.initial_state.end(), {1.0, 0.0});
    problem.rhs = [copies](double, State y, std::span<double> ydot) {
        for (std::size_t k = 0; k < copies; ++k) {
            ydot[2 * k] = y[2 * k + 1];
            ydot[2 * k + 1] = -y[2 * k];
        }
    };
    for (const double rtol : {1e-4, 1e-6, 1e-9, 1e-12}) {
        OdeOptions options = options_for(Method::erk, rtol);
        double at_ends = 0.0, inside = 0.0;
        const auto error = [](double t, State y) {
            return std::hypot(y[0] - std::cos(t), y[1] + std::sin(t));
        };
        options.on_step = [&](const Step& step) {
            at_ends = std::max(at_ends, error(step.time, step.state));
        };
        const std::vector<double> some = evenly(0.0, 3.0, 300), many = evenly(0.0, 3.0, 3000);
        const Solution solution = solve(problem, options, many);
        for (std::size_t k = 0; k < many.size(); ++k)
            inside = std::max(inside, error(many[k], solution.states[k]));
        CAPTURE(copies, rtol, at_ends, inside, solution.statistics.steps);
        // at 1e-4 a step of order 6 is a radian long, over which the stages vary as much as the solution
        CHECK(inside < (rtol > 1e-5 ? 3.0 : 2.0) * at_ends + 1e-15);
        const long plain = solve(problem, options, std::vector{3.0}).statistics.rhs_evaluations;
        CHECK(solution.statistics.rhs_evaluations <= plain + 8 * solution.statistics.steps);
        if (solution.statistics.steps < 300)
            CHECK(solve(problem, options, some).statistics.rhs_evaluations <=
                  plain + 8 * solution.statistics.steps);
    }
}

TEST_CASE("the right-hand side is not called beyond the last output time", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    double latest = 0.0;
    OdeProblem problem = oscillator();
    problem.rhs = [&, inner = problem.rhs](double t, State y, std::span<double> ydot) {
        latest = std::max(latest, t);
        inner(t, y, ydot);
    };
    const std::vector<double> times{0.5, 1.0};
    CHECK(solve(problem, options_for(method, 1e-6), times).status.ok());
    CHECK(latest <= 1.0 + 1e-15); // four roundings of the end time
}

TEST_CASE("start time only, and an end one rounding away", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeProblem problem = oscillator();
    problem.start_time = 1.0;
    const std::vector<double> start{1.0}, next{std::nextafter(1.0, 2.0)};
    const Solution at_start = solve(problem, options_for(method, 1e-6), start);
    CHECK(at_start.status.termination == Termination::reached_end);
    CHECK(at_start.final_state == problem.initial_state);
    const Solution near = solve(problem, options_for(method, 1e-6), next);
    CHECK(near.status.termination == Termination::reached_end);
    CHECK(near.times == next);
    CHECK(std::abs(near.final_state[0] - 1.0) < 1e-15); // moves by epsilon^2
}

TEST_CASE("on_step sees the steps join up", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeOptions options = options_for(method, 1e-6);
    double last_time = 0.0;
    std::vector<double> last_state{1.0, 0.0};
    long steps = 0, breaks = 0;
    options.segment_steps = 7;
    options.on_step = [&](const Step& step) {
        ++steps;
        const bool joins = step.time_before == last_time && step.time > step.time_before &&
                           std::equal(last_state.begin(), last_state.end(), step.state_before.begin());
        if (!joins)
            ++breaks;
        last_time = step.time;
        last_state.assign(step.state.begin(), step.state.end());
    };
    const std::vector<double> times{5.0};
    const Solution solution = solve(oscillator(), options, times);
    CHECK(breaks == 0);
    CHECK(steps == solution.statistics.steps);
    CHECK(last_time == 5.0);
    CHECK(last_state == solution.final_state);
}

TEST_CASE("a step limit keeps a quiet right-hand side from stepping over a bump", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    constexpr double at = 100.3, width = 0.05; // y' = normalised bump: y rises from 0 to 1 at t = 100.3
    OdeProblem problem;
    problem.initial_state = {0.0};
    problem.rhs = [](double t, State, std::span<double> ydot) {
        const double u = (t - at) / width;
        ydot[0] = std::exp(-u * u) / (width * std::sqrt(std::numbers::pi));
    };
    const std::vector<double> end{200.0};
    const OdeOptions options = options_for(method, 1e-8);
    CHECK(solve(problem, options, end).final_state[0] < 0.5); // stepped over: why the limit is there
    problem.step_limit = [](double t, State) { return std::max(0.01, 0.2 * std::abs(t - at)); };
    CHECK(std::abs(solve(problem, options, end).final_state[0] - 1.0) < 1e-6); // 100 times rtol
}
