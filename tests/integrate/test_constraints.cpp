// States that must stay on a manifold, by projection, and constraints that are part of the system (IDAS).

#include "problems.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>
#include <numbers>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

namespace {

/// Unit vectors that turn at the rates 1, 2, ...: (cos k t, sin k t) is on the unit circle.
OdeProblem rotors(std::size_t count) {
    OdeProblem problem;
    for (std::size_t k = 0; k < count; ++k)
        problem.initial_state.insert(problem.initial_state.end(), {1.0, 0.0});
    problem.rhs = [](double, State y, std::span<double> ydot) {
        for (std::size_t i = 0; i < y.size(); i += 2) {
            const double rate = 1.0 + static_cast<double>(i / 2);
            ydot[i] = -rate * y[i + 1];
            ydot[i + 1] = rate * y[i];
        }
    };
    return problem;
}

double off_circle(State y) {
    double most = 0.0;
    for (std::size_t i = 0; i < y.size(); i += 2)
        most = std::max(most, std::abs(std::hypot(y[i], y[i + 1]) - 1.0));
    return most;
}

double to_circle(std::span<double> y) {
    const double drift = off_circle(y);
    for (std::size_t i = 0; i < y.size(); i += 2) {
        const double length = std::hypot(y[i], y[i + 1]);
        y[i] /= length;
        y[i + 1] /= length;
    }
    return drift;
}

double error_of(const Solution& solution) {
    double error = 0.0;
    for (std::size_t i = 0; i < solution.final_state.size(); i += 2) {
        const double angle = (1.0 + static_cast<double>(i / 2)) * solution.final_time;
        error = std::max(error, std::hypot(solution.final_state[i] - std::cos(angle),
                                           solution.final_state[i + 1] - std::sin(angle)));
    }
    return error;
}

/// x' = -z, 0 = z - x^2: x = 1/(1 + t). The first guess of z is far off.
OdeProblem constrained() {
    OdeProblem problem;
    problem.initial_state = {1.0, 3.0};
    problem.rhs = [](double, State y, std::span<double> f) {
        f[0] = -y[1];
        f[1] = y[1] - y[0] * y[0];
    };
    problem.algebraic = {false, true};
    return problem;
}

OdeProblem with_jacobian(OdeProblem problem, double sign = 1.0) {
    problem.jacobian = [sign](double, State y, Eigen::Ref<Eigen::MatrixXd> jacobian) {
        jacobian << 0.0, -1.0, -2.0 * sign * y[0], 1.0;
    };
    return problem;
}

} // namespace

TEST_CASE("a projection keeps the state on its manifold and costs no accuracy", "[integrate]") {
    const std::vector<double> times{10.0};
    // one rotor: the stepper of few components; 20: ARKODE
    for (const auto& [method, count] :
         {std::pair{Method::bdf, 1U}, {Method::bdf, 20U}, {Method::erk, 1U}, {Method::erk, 20U}}) {
        CAPTURE(to_string(method), count);
        OdeProblem problem = rotors(count);
        const OdeOptions options = options_for(method, 1e-6);
        const Solution plain = solve(problem, options, times);
        problem.project = to_circle;
        const Solution projected = solve(problem, options, times);
        REQUIRE(projected.status.ok());
        CHECK(off_circle(projected.final_state) < 1e-15); // roundings of a division
        CHECK(off_circle(plain.final_state) > 1e-10);     // without, errors add up
        CHECK(plain.statistics.drift == 0.0);
        CHECK(projected.statistics.drift > 0.0);
        CHECK(projected.statistics.drift < 1e-5);                   // a step's error, ten times rtol
        CHECK(error_of(projected) < 2.0 * error_of(plain) + 1e-12); // phases are what is left
    }
}

TEST_CASE("index-1 constraints are solved with the equations, from inconsistent guesses", "[integrate]") {
    const std::vector<double> times = evenly(0.0, 4.0, 8);
    for (const OdeProblem& problem : {constrained(), with_jacobian(constrained())})
        for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-10}) {
            CAPTURE(rtol);
            const Solution solution = solve(problem, options_for(Method::bdf, rtol), times);
            REQUIRE(solution.status.termination == Termination::reached_end);
            for (std::size_t k = 1; k < times.size(); ++k) {
                const double x = 1.0 / (1.0 + times[k]);
                CHECK(std::abs(solution.states[k][0] - x) < 10.0 * rtol); // local errors over 4 time units
                CHECK(std::abs(solution.states[k][1] - x * x) < 20.0 * rtol); // 2 x times that
            }
        }
}

TEST_CASE("IDAS uses the Jacobian it is given", "[integrate]") {
    const std::vector<double> times{4.0};
    OdeOptions options = options_for(Method::bdf, 1e-8);
    options.max_steps = 5000;
    const Solution right = solve(with_jacobian(constrained()), options, times);
    const Solution wrong = solve(with_jacobian(constrained(), -1.0), options, times);
    CHECK(right.statistics.convergence_failures == 0);
    CHECK(right.statistics.jacobian_evaluations > 0);
    CHECK((wrong.statistics.convergence_failures > 0 || !wrong.status.ok()));
}

TEST_CASE("events are found and solves resumed with constraints too", "[integrate]") {
    OdeProblem problem = constrained();
    problem.events = {{"half", [](double, State y) { return y[0] - 0.5; }, Crossing::falling, true}};
    const Solution half = solve(problem, options_for(Method::bdf, 1e-9), std::vector{4.0});
    REQUIRE(half.status.termination == Termination::stopped_at_event);
    CHECK(half.final_time == Approx(1.0).epsilon(1e-7)); // 10 rtol over the slope, 1/4

    OdeOptions options = options_for(Method::bdf, 1e-9);
    options.segment_steps = 100; // each begins with short steps
    std::vector<std::pair<double, std::vector<double>>> saved;
    options.on_segment = [&](const Segment& s) {
        saved.emplace_back(s.time, std::vector(s.state.begin(), s.state.end()));
    };
    const Solution whole = solve(constrained(), options, std::vector{4.0});
    REQUIRE(whole.status.ok());
    REQUIRE(saved.size() > 1);
    for (const auto& [time, state] : std::vector(saved)) {
        OdeProblem rest = constrained();
        rest.start_time = time;
        rest.initial_state = state;
        CHECK(solve(rest, options, std::vector{4.0}).final_state == whole.final_state);
    }
}

TEST_CASE("what does not go with constraints and projections is refused", "[integrate]") {
    const auto refused = [](const OdeProblem& problem, Method method, const char* why) {
        CHECK_THROWS_WITH(solve(problem, options_for(method, 1e-6), std::vector{1.0}), Catch::Contains(why));
    };
    refused(constrained(), Method::erk, "method erk has none; use bdf");
    refused(constrained(), Method::adams, "method adams has none; use bdf");
    OdeProblem problem = constrained();
    problem.algebraic = {true, true};
    refused(problem, Method::bdf, "nothing moves");
    problem.algebraic = {true};
    refused(problem, Method::bdf, "1 components are marked as algebraic or not, but there are 2 components");
    problem = rotors(1);
    problem.project = to_circle;
    refused(problem, Method::adams, "adams takes none");
}

TEST_CASE("constraints without a solution end in a named failure", "[integrate]") {
    OdeProblem problem = constrained();
    problem.rhs = [](double, State y, std::span<double> f) {
        f[0] = -y[1];
        f[1] = y[1] * y[1] + 1.0;
    };
    const Solution solution = solve(problem, options_for(Method::bdf, 1e-6), std::vector{1.0});
    CHECK_FALSE(solution.status.ok());
    CHECK_THAT(solution.status.message(), Catch::Contains("IDA_") && Catch::Contains("Try: "));
}
