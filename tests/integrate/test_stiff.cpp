// Stiff problems by BDF, and the use it makes of the Jacobian.

#include "convergence.hpp"
#include "problems.hpp"

#include <catch2/catch.hpp>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

namespace {

OdeProblem robertson() {
    OdeProblem problem;
    problem.initial_state = {1.0, 0.0, 0.0};
    problem.rhs = [](double, State y, std::span<double> ydot) {
        ydot[0] = -0.04 * y[0] + 1e4 * y[1] * y[2];
        ydot[2] = 3e7 * y[1] * y[1];
        ydot[1] = -ydot[0] - ydot[2];
    };
    problem.jacobian = [](double, State y, Eigen::Ref<Eigen::MatrixXd> jacobian) {
        jacobian.row(0) << -0.04, 1e4 * y[2], 1e4 * y[1];
        jacobian.row(2) << 0.0, 6e7 * y[1], 0.0;
        jacobian.row(1) = -jacobian.row(0) - jacobian.row(2);
    };
    return problem;
}

/// y' = lambda (y - cos t) - sin t, y = cos t (Prothero and Robinson 1974).
OdeProblem prothero_robinson(double lambda, double jacobian_entry) {
    OdeProblem problem;
    problem.initial_state = {1.0};
    problem.rhs = [lambda](double t, State y, std::span<double> ydot) {
        ydot[0] = lambda * (y[0] - std::cos(t)) - std::sin(t);
    };
    problem.jacobian = [jacobian_entry](double, State, Eigen::Ref<Eigen::MatrixXd> jacobian) {
        jacobian(0, 0) = jacobian_entry;
    };
    return problem;
}

OdeOptions tight_bdf() {
    OdeOptions options;
    options.method = Method::bdf;
    options.rtol = 1e-9;
    options.atol = 1e-14;
    return options;
}

} // namespace

TEST_CASE("Robertson's kinetics to t = 1e11", "[integrate]") {
    // At 0.4, 40, 4000: as printed by the SUNDIALS example cvRoberts_dns, 5 digits. At 1e11: Hairer and
    // Wanner, Solving Ordinary Differential Equations II, reference solution of ROBER.
    const std::vector<double> times{0.4, 40.0, 4000.0, 1e11};
    const Solution solution = solve(robertson(), tight_bdf(), times);
    REQUIRE(solution.status.termination == Termination::reached_end);
    const double y1[] = {9.8517e-1, 7.1583e-1, 1.8320e-1};
    const double y2[] = {3.3864e-5, 9.1855e-6, 8.9424e-7};
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(solution.states[k][0] == Approx(y1[k]).epsilon(2e-4)); // their rtol is 1e-4
        CHECK(solution.states[k][1] == Approx(y2[k]).epsilon(2e-4)); // their rtol is 1e-4
    }
    CHECK(solution.final_state[0] == Approx(0.2083340149701255e-7).epsilon(1e-5)); // atol / y over some steps
    CHECK(solution.final_state[1] == Approx(0.8333360770334713e-13).epsilon(1e-5)); // follows the first
    for (const auto& y : solution.states)
        CHECK(std::abs(y[0] + y[1] + y[2] - 1.0) <
              1e-12); // linear invariant: kept to round-off of ~1000 steps
    CHECK(solution.statistics.jacobian_evaluations > 0);
}

TEST_CASE("difference quotients serve when there is no Jacobian", "[integrate]") {
    OdeProblem problem = robertson();
    const std::vector<double> times{40.0};
    const Solution exact = solve(problem, tight_bdf(), times);
    problem.jacobian = nullptr;
    const Solution approximate = solve(problem, tight_bdf(), times);
    REQUIRE(approximate.status.ok());
    CHECK(approximate.statistics.jacobian_evaluations > 0);
    CHECK(approximate.final_state[0] ==
          Approx(exact.final_state[0]).epsilon(1e-7)); // 100 rtol: global over local error
}

TEST_CASE("Prothero-Robinson at stiffness 1e6 takes few steps", "[integrate]") {
    const double lambda = -1e6;
    const std::vector<double> times = evenly(0.0, 10.0, 10);
    const Solution solution = solve(prothero_robinson(lambda, lambda), options_for(Method::bdf, 1e-8), times);
    REQUIRE(solution.status.termination == Termination::reached_end);
    for (std::size_t k = 0; k < times.size(); ++k)
        CHECK(std::abs(solution.states[k][0] - std::cos(times[k])) < 1e-6); // 100 rtol
    CHECK(solution.statistics.steps < 5000); // an explicit method needs |lambda| t / 3 = 3 million
}

TEST_CASE("the supplied Jacobian is the one that is used", "[integrate]") {
    const double lambda = -1e6;
    const std::vector<double> times{1.0};
    OdeOptions options = options_for(Method::bdf, 1e-6);
    options.max_steps = 20000;
    const Solution right = solve(prothero_robinson(lambda, lambda), options, times);
    const Solution wrong = solve(prothero_robinson(lambda, -lambda), options, times);
    CHECK(right.statistics.convergence_failures == 0);
    CHECK(wrong.statistics.convergence_failures > 0);
    CHECK(wrong.statistics.jacobian_evaluations > 0);
}

TEST_CASE("the Jacobian's element (i, j) is d rhs_i / d y_j", "[integrate]") {
    // y0' = -1e6 (y0 - y1), y1' = 0: the transpose would break Newton.
    OdeProblem problem;
    problem.initial_state = {1.0, 2.0};
    problem.rhs = [](double, State y, std::span<double> ydot) {
        ydot[0] = -1e6 * (y[0] - y[1]);
        ydot[1] = 1.0;
    };
    bool was_zero = true;
    problem.jacobian = [&](double, State, Eigen::Ref<Eigen::MatrixXd> jacobian) {
        was_zero = was_zero && jacobian.isZero(0.0);
        jacobian(0, 0) = -1e6;
        jacobian(0, 1) = 1e6;
    };
    const std::vector<double> times{1.0};
    const Solution solution = solve(problem, options_for(Method::bdf, 1e-8), times);
    CHECK(was_zero);
    CHECK(solution.statistics.convergence_failures == 0);
    CHECK(solution.final_state[0] ==
          Approx(3.0 - 1e-6).epsilon(1e-8)); // lag 1 / 1e6; rtol, damped by the stiffness
}

// --- The error follows the tolerance, and what is exact in theory is exact here

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
