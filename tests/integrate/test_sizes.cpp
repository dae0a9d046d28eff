// ERK takes steps of its own for few components and ARKODE's for many: the same promises on both sides.

#include "problems.hpp"

#include <catch2/catch.hpp>

#include <stdexcept>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;
using Catch::Matchers::Contains;

namespace {

/// Oscillators side by side, which know nothing of each other; `spoil` may change their rates.
OdeProblem oscillators(std::size_t count, std::function<void(double, std::span<double>)> spoil = nullptr) {
    OdeProblem problem;
    for (std::size_t k = 0; k < count; ++k)
        problem.initial_state.insert(problem.initial_state.end(), {1.0, 0.0});
    problem.rhs = [spoil](double t, State y, std::span<double> ydot) {
        for (std::size_t k = 0; k < y.size(); k += 2) {
            ydot[k] = y[k + 1];
            ydot[k + 1] = -y[k];
        }
        if (spoil)
            spoil(t, ydot);
    };
    return problem;
}

double worst_error(const Solution& solution) {
    double worst = 0.0;
    for (std::size_t k = 0; k < solution.times.size(); ++k)
        for (const std::size_t i : {std::size_t{0}, solution.states[k].size() - 2})
            worst = std::max(worst, std::abs(solution.states[k][i] - std::cos(solution.times[k])));
    return worst;
}

constexpr std::size_t small_side = 13, large_side = 14; // 26 and 28 components

std::string prefix(std::size_t count) { return count == small_side ? "ERK_" : "ARK_"; }

} // namespace

TEST_CASE("ERK keeps its promise for few and for many components", "[integrate]") {
    const std::size_t count = GENERATE(small_side, large_side);
    for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-11}) {
        const Solution solution =
            solve(oscillators(count), options_for(Method::erk, rtol), evenly(0.0, 10.0, 40));
        REQUIRE(solution.status.ok());
        INFO(count << " oscillators, rtol " << rtol);
        CHECK(worst_error(solution) < 83.0 * rtol); // studies/reports/rods.md, "Trajectories"
    }
}

TEST_CASE("ERK resumes to the bit for few and for many components", "[integrate]") {
    const std::size_t count = GENERATE(small_side, large_side);
    OdeOptions options = options_for(Method::erk, 1e-9);
    options.segment_steps = 23;
    const std::vector<double> times{7.5, 20.0};
    OdeProblem problem = oscillators(count);
    std::vector<std::pair<double, std::vector<double>>> saved;
    options.on_segment = [&](const Segment& segment) {
        saved.emplace_back(segment.time, std::vector(segment.state.begin(), segment.state.end()));
    };
    const Solution whole = solve(problem, options, times);
    options.on_segment = nullptr;
    REQUIRE(saved.size() > 2);
    problem.start_time = saved.back().first;
    problem.initial_state = saved.back().second;
    REQUIRE(problem.start_time > 7.5);
    CHECK(solve(problem, options, std::span(times).subspan(1)).final_state == whole.final_state);
}

TEST_CASE("ERK fails for the same causes with few and with many components", "[integrate]") {
    const std::size_t count = GENERATE(small_side, large_side);
    const OdeOptions options = options_for(Method::erk, 1e-6);
    const auto failed = [&](std::function<void(double, std::span<double>)> spoil) {
        const Solution solution =
            solve(oscillators(count, std::move(spoil)), options, std::vector<double>{2.0});
        CHECK(solution.status.termination == Termination::failed);
        CHECK_THAT(solution.status.flag, Catch::Matchers::StartsWith(prefix(count)));
        return solution.status;
    };
    const Status thrown = failed([](double t, std::span<double>) {
        if (t > 0.5)
            throw std::runtime_error("rods touch");
    });
    CHECK(thrown.flag == prefix(count) + "RHSFUNC_FAIL");
    CHECK_THAT(thrown.message(), Contains("rods touch"));
    const Status nan = failed([](double t, std::span<double> ydot) {
        if (t > 0.5)
            ydot[3] = std::nan("");
    });
    CHECK_THAT(nan.message(), Contains("y[3] was nan"));
    CHECK(nan.reached > 0.49);
    const Status at_start =
        failed([](double, std::span<double> ydot) { ydot[0] = std::numeric_limits<double>::infinity(); });
    CHECK_THAT(at_start.message(), Contains("y[0] was inf at t=0"));
    OdeOptions short_of_steps = options;
    short_of_steps.max_steps = 3;
    const Solution tired = solve(oscillators(count), short_of_steps, std::vector<double>{20.0});
    CHECK(tired.status.flag == prefix(count) + "TOO_MUCH_WORK");
    CHECK(tired.statistics.steps == 3);
}

TEST_CASE("ERK keeps to the longest step and to the end for few and for many components", "[integrate]") {
    const std::size_t count = GENERATE(small_side, large_side);
    OdeProblem problem = oscillators(count);
    problem.step_limit = [](double t, State) { return t < 1.0 ? 0.01 : 0.05; };
    OdeOptions options = options_for(Method::erk, 1e-4);
    double longest_before = 0.0, longest_after = 0.0, last = 0.0;
    options.on_step = [&](const Step& step) {
        double& longest = step.time_before < 0.99 ? longest_before : longest_after;
        longest = std::max(longest, step.time - step.time_before);
        last = step.time;
    };
    CHECK(solve(problem, options, std::vector<double>{3.0}).status.ok());
    CHECK(longest_before <= 0.01 * (1.0 + 1e-12)); // as the difference of two times
    CHECK(longest_after <= 0.05 * (1.0 + 1e-12));
    CHECK(longest_after > 0.04);
    CHECK(last == 3.0);
}
