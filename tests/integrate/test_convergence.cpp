// The error follows the tolerance, and what is exact in theory is exact here.

#include "convergence.hpp"
#include "problems.hpp"

#include <catch2/catch.hpp>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

namespace {

double decay_error(Method method, double rtol) {
    const Solution solution = solve(decay(), options_for(method, rtol), evenly(0.0, 3.0, 20));
    REQUIRE(solution.status.termination == Termination::reached_end);
    double worst = 0.0;
    for (std::size_t k = 0; k < solution.times.size(); ++k)
        worst = std::max(worst, std::abs(solution.states[k][0] - std::exp(-solution.times[k])));
    return worst;
}

double oscillator_error(Method method, double rtol) {
    const Solution solution = solve(oscillator(), options_for(method, rtol), evenly(0.0, 10.0, 40));
    REQUIRE(solution.status.termination == Termination::reached_end);
    double worst = 0.0;
    for (std::size_t k = 0; k < solution.times.size(); ++k)
        worst = std::max(worst, std::hypot(solution.states[k][0] - std::cos(solution.times[k]),
                                           solution.states[k][1] + std::sin(solution.times[k])));
    return worst;
}

} // namespace

TEST_CASE("error follows rtol from 1e-4 to 1e-11", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const auto error = GENERATE(&decay_error, &oscillator_error);
    INFO(to_string(method));
    const Ladder ladder = climb(4, 11, [&](double rtol) { return error(method, rtol); });
    INFO(describe(ladder));
    // Proportional is 1; a variable-order method scatters by its changes of order, 0.3 over seven decades.
    CHECK(slope(ladder) > 0.7);
    CHECK(slope(ladder) < 1.3);
    CHECK(falls(ladder));
    for (std::size_t i = 0; i < ladder.rtol.size(); ++i)
        CHECK(ladder.error[i] < 500.0 * ladder.rtol[i]); // local errors add up over up to 600 steps
}

TEST_CASE("the ladder's judges reject what they should", "[integrate]") {
    const Ladder flat = climb(4, 11, [](double) { return 1e-6; });
    const Ladder half = climb(4, 11, [](double rtol) { return std::sqrt(rtol); });
    const Ladder bump = climb(4, 11, [](double rtol) { return rtol < 2e-7 && rtol > 2e-8 ? 1e-3 : rtol; });
    const Ladder good = climb(4, 11, [](double rtol) { return 30.0 * rtol; });
    CHECK(slope(flat) < 0.7);
    CHECK_FALSE(falls(flat));
    CHECK(slope(half) < 0.7);
    CHECK_FALSE(falls(bump));
    CHECK(falls(good));
    CHECK(slope(good) == Approx(1.0).epsilon(1e-12)); // a straight line but for the round-off of log
}

TEST_CASE("a polynomial of the method's order is integrated to round-off", "[integrate]") {
    // y' = p'(t): the error of an order-p step vanishes for degree p, and fixed order 1 start-up steps of the
    // multistep methods are exact for degree 1.
    const auto [method, rtol, degree] = GENERATE(table<Method, double, int>(
        {{Method::erk, 1e-4, 6}, {Method::erk, 1e-8, 6}, {Method::adams, 1e-6, 1}, {Method::bdf, 1e-6, 1}}));
    OdeProblem problem;
    problem.initial_state = {1.0};
    problem.rhs = [degree = degree](double t, State, std::span<double> ydot) {
        ydot[0] = degree * std::pow(t, degree - 1);
    };
    const Solution solution = solve(problem, options_for(method, rtol), evenly(0.0, 2.0, 7));
    REQUIRE(solution.status.ok());
    INFO(to_string(method) << " degree " << degree);
    for (std::size_t k = 0; k < solution.times.size(); ++k) {
        const double exact = 1.0 + std::pow(solution.times[k], degree);
        // round-off of a few dozen steps, 500 epsilon of what is largest in the step
        CHECK(std::abs(solution.states[k][0] - exact) < 1e-13 * (1.0 + std::pow(2.0, degree)));
    }
}

TEST_CASE("one degree more is not exact", "[integrate]") {
    OdeProblem problem;
    problem.initial_state = {0.0};
    problem.rhs = [](double t, State, std::span<double> ydot) { ydot[0] = 7.0 * std::pow(t, 6); };
    const std::vector<double> end{2.0};
    const Solution solution = solve(problem, options_for(Method::erk, 1e-4), end); // order 6
    CHECK(std::abs(solution.final_state[0] - 128.0) > 1e-10); // far above round-off, 1e-14 x 128
}
