// Sensitivities against closed forms, for both multistep methods.

#include "problems.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/integrate/sensitivity.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::integrate;
using namespace rodwake::integrate::test;
using Catch::Matchers::Contains;
using Matrix = Eigen::Ref<Eigen::MatrixXd>;

namespace {

constexpr Method multistep[] = {Method::adams, Method::bdf};

/// Local errors add up over the few hundred steps of these problems; measured below 20 rtol.
constexpr double accumulated = 100.0;

/// y' = -p0 y + p1, y(0) = p2.
SensitivityProblem relaxation(double p0, double p1, double p2) {
    SensitivityProblem problem;
    problem.ode.initial_state = {p2};
    problem.ode.rhs = [=](double, State y, std::span<double> ydot) { ydot[0] = -p0 * y[0] + p1; };
    problem.ode.jacobian = [=](double, State, Matrix jacobian) { jacobian(0, 0) = -p0; };
    problem.parameters = 3;
    problem.by_parameter = [](double, State y, Matrix by) {
        by(0, 0) = -y[0];
        by(0, 1) = 1.0;
    };
    problem.initial = Eigen::RowVector3d(0.0, 0.0, 1.0);
    problem.parameter_scale = {1.0, 1.0, 1.0};
    return problem;
}

Eigen::RowVector3d relaxation_slopes(double t, double p0, double p1, double p2) {
    const double e = std::exp(-p0 * t);
    return {-t * e * (p2 - p1 / p0) - p1 / (p0 * p0) * (1.0 - e), (1.0 - e) / p0, e};
}

/// y' = r y (1 - y/K).
SensitivityProblem logistic(double r, double K, double y0) {
    SensitivityProblem problem;
    problem.ode.initial_state = {y0};
    problem.ode.rhs = [=](double, State y, std::span<double> ydot) { ydot[0] = r * y[0] * (1.0 - y[0] / K); };
    problem.ode.jacobian = [=](double, State y, Matrix jacobian) {
        jacobian(0, 0) = r * (1.0 - 2.0 * y[0] / K);
    };
    problem.parameters = 2;
    problem.by_parameter = [=](double, State y, Matrix by) {
        by(0, 0) = y[0] * (1.0 - y[0] / K);
        by(0, 1) = r * y[0] * y[0] / (K * K);
    };
    problem.initial = Eigen::RowVector2d::Zero();
    problem.parameter_scale = {r, K};
    return problem;
}

/// y = K/(1 + A e^-rt), A = K/y0 - 1.
Eigen::RowVector2d logistic_slopes(double t, double r, double K, double y0) {
    const double A = K / y0 - 1.0, e = std::exp(-r * t), bottom = 1.0 + A * e;
    return {K * A * t * e / (bottom * bottom), 1.0 / bottom - K * e / y0 / (bottom * bottom)};
}

/// x'' = -w^2 x.
SensitivityProblem swinging(double w) {
    SensitivityProblem problem;
    problem.ode.initial_state = {1.0, 0.0};
    problem.ode.rhs = [=](double, State y, std::span<double> ydot) {
        ydot[0] = y[1];
        ydot[1] = -w * w * y[0];
    };
    problem.ode.jacobian = [=](double, State, Matrix jacobian) {
        jacobian(0, 1) = 1.0;
        jacobian(1, 0) = -w * w;
    };
    problem.parameters = 1;
    problem.by_parameter = [=](double, State y, Matrix by) { by(1, 0) = -2.0 * w * y[0]; };
    problem.initial = Eigen::Vector2d::Zero();
    problem.parameter_scale = {w};
    return problem;
}

/// A ball let go at height h hits the ground; parameters g and h.
SensitivityProblem falling(double g, double h) {
    SensitivityProblem problem;
    problem.ode = ballistic(h, 0.0, -g);
    problem.ode.jacobian = [](double, State, Matrix jacobian) { jacobian(0, 1) = 1.0; };
    problem.ode.events = {component_event(0, Crossing::falling, true)};
    problem.parameters = 2;
    problem.by_parameter = [](double, State, Matrix by) { by(1, 0) = -1.0; };
    problem.initial = Eigen::Matrix2d::Zero();
    problem.initial(0, 1) = 1.0;
    problem.parameter_scale = {g, h};
    problem.event_gradient = {[](double, State) { return Eigen::VectorXd(Eigen::Vector2d(1.0, 0.0)); }};
    return problem;
}

double largest(const Eigen::MatrixXd& a) { return a.cwiseAbs().maxCoeff(); }

} // namespace

TEST_CASE("sensitivities of a linear problem, initial value among the parameters") {
    const std::vector<double> times = evenly(0.0, 4.0, 8);
    for (const Method method : multistep)
        for (const double rtol : {1e-6, 1e-10}) {
            const auto result =
                solve_with_sensitivities(relaxation(0.7, 1.3, 2.0), options_for(method, rtol), times);
            CAPTURE(to_string(method), rtol);
            REQUIRE(result.solution.status.ok());
            REQUIRE(result.sensitivities.size() == times.size());
            for (std::size_t k = 0; k < times.size(); ++k)
                CHECK(largest(result.sensitivities[k] - relaxation_slopes(times[k], 0.7, 1.3, 2.0)) <
                      accumulated * rtol);
            CHECK(result.final_sensitivity == result.sensitivities.back());
            CHECK(result.event_time_by_parameter.size() == 0);
        }
}

TEST_CASE("sensitivities of a nonlinear problem") {
    const std::vector<double> times = evenly(0.0, 6.0, 5);
    for (const Method method : multistep)
        for (const double rtol : {1e-6, 1e-10}) {
            const auto result =
                solve_with_sensitivities(logistic(1.5, 3.0, 0.2), options_for(method, rtol), times);
            CAPTURE(to_string(method), rtol);
            REQUIRE(result.solution.status.ok());
            for (std::size_t k = 0; k < times.size(); ++k)
                CHECK(largest(result.sensitivities[k] - logistic_slopes(times[k], 1.5, 3.0, 0.2)) <
                      accumulated * rtol);
        }
}

TEST_CASE("sensitivities that grow with time, by Adams and BDF, in segments too") {
    const double w = 1.7, t = 20.0;
    for (const Method method : multistep)
        for (const long segment : {20000L, 40L}) {
            OdeOptions options = options_for(method, 1e-9);
            options.segment_steps = segment;
            const auto result = solve_with_sensitivities(swinging(w), options, std::vector{t});
            CAPTURE(to_string(method), segment);
            REQUIRE(result.solution.status.ok());
            const Eigen::Vector2d exact(-t * std::sin(w * t), -std::sin(w * t) - w * t * std::cos(w * t));
            // phase errors add up over 20/0.03 steps and S is t times as large as y
            CHECK(largest(result.final_sensitivity - exact) < 2000.0 * t * 1e-9);
        }
}

TEST_CASE("a stiff problem's sensitivities by BDF take few steps") {
    // After the layer y is p1/p0, and its derivative by p0 is 1e-6 of y.
    const double p0 = 1e6, p1 = 1e6;
    SensitivityProblem problem = relaxation(p0, p1, 2.0);
    problem.parameter_scale = {p0, p1, 1.0};
    const auto result = solve_with_sensitivities(problem, options_for(Method::bdf, 1e-8), std::vector{10.0});
    REQUIRE(result.solution.status.ok());
    CHECK(result.solution.statistics.steps < 2000); // explicit steps: 5e6
    const Eigen::RowVector3d exact = relaxation_slopes(10.0, p0, p1, 2.0);
    for (int j = 0; j < 2; ++j)
        CHECK(result.final_sensitivity(0, j) == Approx(exact[j]).epsilon(1e-6));
}

TEST_CASE("the time of an event depends on the parameters: a falling ball") {
    const double g = 9.8, h = 3.0, hit = std::sqrt(2.0 * h / g);
    for (const Method method : multistep) {
        const auto result =
            solve_with_sensitivities(falling(g, h), options_for(method, 1e-9), std::vector{0.5, 5.0});
        CAPTURE(to_string(method));
        REQUIRE(result.solution.status.termination == Termination::stopped_at_event);
        REQUIRE(result.sensitivities.size() == 1);
        REQUIRE(result.event_time_by_parameter.size() == 2);
        const double bound = accumulated * 1e-9;
        CHECK(std::abs(result.solution.final_time - hit) < bound);
        CHECK(std::abs(result.event_time_by_parameter[0] + 0.5 * hit / g) < bound);
        CHECK(std::abs(result.event_time_by_parameter[1] - 0.5 * hit / h) < bound);
        // the speed at the ground is -sqrt(2 g h): total derivative from that at fixed time
        const double by_g = result.final_sensitivity(1, 0) - g * result.event_time_by_parameter[0];
        CHECK(std::abs(by_g + std::sqrt(0.5 * h / g)) < 10.0 * bound);
    }
}

TEST_CASE("an event that depends on the parameters itself: the ground is one of them") {
    SensitivityProblem problem = falling(9.8, 3.0);
    problem.event_gradient = {
        [](double, State) { return Eigen::VectorXd(Eigen::Vector4d(1.0, 0.0, 0.0, -1.0)); }};
    const auto result = solve_with_sensitivities(problem, options_for(Method::adams, 1e-9), std::vector{5.0});
    // ground rises as h does: dg/dh = -1 takes away what the start adds
    CHECK(std::abs(result.event_time_by_parameter[1]) < 1e-7);
}

TEST_CASE("a wrong Jacobian gives wrong sensitivities: these tests would notice") {
    SensitivityProblem wrong = logistic(1.5, 3.0, 0.2);
    wrong.ode.jacobian = [](double, State y, Matrix jacobian) {
        jacobian(0, 0) = 1.5 * (1.0 - 1.9 * y[0] / 3.0);
    };
    for (const Method method : multistep) {
        const auto result = solve_with_sensitivities(wrong, options_for(method, 1e-10), std::vector{3.0});
        REQUIRE(result.solution.status.ok());
        CHECK(largest(result.final_sensitivity - logistic_slopes(3.0, 1.5, 3.0, 0.2)) > 1e-3);
    }
}

TEST_CASE("the states are those of a solve without sensitivities, to the tolerance") {
    const std::vector<double> times = evenly(0.0, 6.0, 6);
    const SensitivityProblem problem = logistic(1.5, 3.0, 0.2);
    for (const Method method : multistep) {
        const OdeOptions options = options_for(method, 1e-9);
        const Solution with = solve_with_sensitivities(problem, options, times).solution,
                       without = solve(problem.ode, options, times);
        for (std::size_t k = 0; k < times.size(); ++k)
            CHECK(std::abs(with.states[k][0] - without.states[k][0]) < accumulated * 1e-9);
    }
}

TEST_CASE("the step limit and the ceiling on steps hold with sensitivities") {
    SensitivityProblem problem = relaxation(0.7, 1.3, 2.0);
    problem.ode.step_limit = [](double, State) { return 0.01; };
    OdeOptions options = options_for(Method::adams, 1e-6);
    CHECK(solve_with_sensitivities(problem, options, std::vector{1.0}).solution.statistics.steps >= 100);
    options.max_steps = 50;
    const auto stopped = solve_with_sensitivities(problem, options, std::vector{1.0});
    CHECK(stopped.solution.status.termination == Termination::failed);
    CHECK(stopped.solution.status.flag == "CV_TOO_MUCH_WORK");
    const double t = stopped.solution.final_time;
    CHECK(t > 0.0);
    CHECK(largest(stopped.final_sensitivity - relaxation_slopes(t, 0.7, 1.3, 2.0)) < 1e-4);
}

TEST_CASE("functions of sensitivities that fail are reported, not thrown") {
    for (const Method method : multistep) {
        SensitivityProblem problem = relaxation(0.7, 1.3, 2.0);
        problem.by_parameter = [](double t, State, Matrix by) {
            if (t > 0.5)
                throw std::runtime_error("out of paper");
            by(0, 1) = 1.0;
        };
        auto result = solve_with_sensitivities(problem, options_for(method, 1e-8), std::vector{1.0});
        CHECK(result.solution.status.termination == Termination::failed);
        CHECK_THAT(result.solution.status.message(), Contains("out of paper"));
        CHECK(result.solution.final_time <= 0.5);

        problem.by_parameter = [](double t, State, Matrix by) { by(0, 0) = t > 0.5 ? std::nan("") : 0.0; };
        result = solve_with_sensitivities(problem, options_for(method, 1e-8), std::vector{1.0});
        CHECK(result.solution.status.termination == Termination::failed);
        CHECK_THAT(result.solution.status.message(), Contains("by the parameters was not finite"));

        problem = falling(9.8, 3.0);
        problem.event_gradient = {[](double, State) { return Eigen::VectorXd(Eigen::Vector3d::Zero()); }};
        result = solve_with_sensitivities(problem, options_for(method, 1e-8), std::vector{5.0});
        CHECK_THAT(result.solution.status.message(), Contains("has 3 components, neither 2 nor 4"));
    }
}

TEST_CASE("malformed sensitivity problems are refused with what is wrong") {
    const std::vector<double> times{1.0};
    const OdeOptions options = options_for(Method::adams, 1e-8);
    const auto refused = [&](auto change, const std::string& text) {
        SensitivityProblem problem = falling(9.8, 3.0);
        change(problem);
        CHECK_THROWS_WITH(solve_with_sensitivities(problem, options, times), Contains(text));
        CHECK_THROWS_AS(solve_with_sensitivities(problem, options, times), InputError);
    };
    refused([](auto& p) { p.parameters = 0; }, "no parameters");
    refused([](auto& p) { p.ode.jacobian = nullptr; }, "no Jacobian");
    refused([](auto& p) { p.by_parameter = nullptr; }, "by the parameters");
    SensitivityProblem projected = falling(9.8, 3.0);
    projected.ode.project = [](std::span<double>) { return 0.0; };
    CHECK_THROWS_WITH(solve_with_sensitivities(projected, options_for(Method::bdf, 1e-8), times),
                      Contains("projected or constrained"));
    refused([](auto& p) { p.initial.resize(1, 2); }, "1 x 2; they must be 2 x 2");
    refused([](auto& p) { p.initial(0, 0) = std::nan(""); }, "not finite");
    refused([](auto& p) { p.parameter_scale = {1.0}; }, "1 parameter scales for 2");
    refused([](auto& p) { p.parameter_scale[1] = 0.0; }, "scale of parameter 1");
    refused([](auto& p) { p.event_gradient.clear(); }, "no gradient");
    CHECK_THROWS_WITH(solve_with_sensitivities(falling(9.8, 3.0), options_for(Method::erk, 1e-8), times),
                      Contains("adams"));
    CHECK_NOTHROW(solve_with_sensitivities(falling(9.8, 3.0), options, times)); // as it is
}
