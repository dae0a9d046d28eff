// Rods that turn to the medium's velocity, and into the rows of a crystal.

#include "rods/interaction.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/noise.hpp"
#include "rodwake/rods/pair_batch.hpp"
#include "rodwake/rods/sensitivity.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

/// -d u/dx in the frame of a rod that has always walked along x, by a difference of order 4.
elastic::Vector velocity(const elastic::Wake& wake, double x, double y) {
    constexpr double h = 1e-3;
    const auto u = [&](double shift) { return wake.at(x + shift, y, {.displacement = true}).displacement; };
    const auto of = [&](auto component) {
        return -(8.0 * (component(u(h)) - component(u(-h))) - (component(u(2 * h)) - component(u(-2 * h)))) /
               (12.0 * h);
    };
    return {of([](const elastic::Vector& v) { return v.x; }),
            of([](const elastic::Vector& v) { return v.y; })};
}

/// Largest difference of the turning rate of with_flow from gamma_flow z.[n x (u_t + drift)].
double worst_difference(const elastic::WakeField& field, double drift) {
    constexpr double gamma = 1.7;
    const elastic::Medium& medium = field.medium();
    const Couplings couplings = with_flow({}, gamma, medium.eta, medium.xi);
    const auto wake = field.wake(0.0);
    RandomStream random(3);
    double worst = 0.0;
    for (int i = 0; i < 50; ++i) {
        const double x = random.uniform(-3, 3), y = random.uniform(0.5, 3), phi = random.uniform(-3, 3);
        const elastic::Vector v = velocity(*wake, x, y);
        const double expected = gamma * (std::cos(phi) * v.y - std::sin(phi) * (v.x + drift));
        const double got = turning_rate(wake->at(x, y, request_of(couplings, false)), couplings,
                                        {std::cos(phi), std::sin(phi)});
        worst = std::max(worst, std::abs(got - expected));
    }
    return worst;
}

RodProblem lone_rod(Rows rows, double heading, double time) {
    RodProblem problem;
    problem.rows = rows;
    problem.rods = {{0.0, 0.0, heading}};
    problem.t_end = time;
    return problem;
}

/// tan 3(theta - direction) falls as exp(-6 gamma t).
double relaxed(Rows rows, double heading, double time) {
    return rows.direction +
           std::atan(std::tan(3.0 * (heading - rows.direction)) * std::exp(-6.0 * rows.gamma * time)) / 3.0;
}

} // namespace

TEST_CASE("turning to the medium's velocity is polar turning, exactly where the theory holds") {
    constexpr double tolerance =
        1e-8; // of the differences: h^4 times the fifth derivative, round-off of u over h
    for (const elastic::Medium medium : {elastic::Medium{1.0, 1.0}, elastic::Medium{3.0, 0.4}, {-0.3, 5.0}})
        CHECK(worst_difference(*elastic::exact_field(medium), 0.0) < tolerance);
    constexpr double side = 12.0;
    const elastic::Medium medium{1.5, 2.0};
    const auto box = elastic::exact_field(medium, PeriodicBox(side));
    const double drift = medium.xi / (side * side); // of the mean, which the field is without
    CHECK(worst_difference(*box, drift) < tolerance);
    CHECK(worst_difference(*box, 0.0) > 1e3 * tolerance); // the check can fail
}

TEST_CASE("rows turn a lone rod as their equation says, in every form and in the path of noise") {
    const Rows rows{0.3, 0.4};
    const double heading = 0.7, time = 2.0, truth = relaxed(rows, heading, time);
    CHECK(truth < heading);
    for (const Form form : {Form::angle, Form::director, Form::dae}) {
        RodOptions options;
        options.form = form;
        options.ode.method = integrate::Method::bdf;
        options.ode.rtol = 1e-9;
        const RodResult run = simulate(lone_rod(rows, heading, time), options);
        INFO(to_string(form) << ": " << run.solution.status.message());
        CHECK(run.solution.final_state[2] ==
              Approx(truth).epsilon(0.0).margin(1e-7)); // 83 rtol, simulate.hpp
    }
    const Noise none{.rotational = 0.0, .translational = 0.0, .time_step = 0.01};
    const RodResult walk = simulate(lone_rod(rows, heading, time), {}, none, 0);
    CHECK(walk.solution.final_state[2] ==
          Approx(truth).epsilon(0.0).margin(1e-5)); // order 2 in steps of 0.01
    CHECK(suitable_time_step(lone_rod(Rows{30.0, 0.0}, heading, time), 0.0) == Approx(0.05 / 180.0));
}

TEST_CASE("the Jacobian and the sensitivities know the rows") {
    RodProblem problem;
    problem.medium = elastic::Medium{1.2, 1.5};
    problem.couplings = {0.4, 0.2, -0.3};
    problem.rows = {0.5, 0.3};
    problem.rods = {{0.0, 2.0, 0.1}, {0.5, -2.0, 0.4}};
    problem.t_end = 3.0;
    CHECK_FALSE(to_pair_problem(problem)); // the batch has no rows: such a pair is integrated by itself
    const Parameter parameters[] = {Parameter::rows_direction, Parameter::kappa, Parameter::rows_gamma};
    const auto sensitive = to_sensitivity_problem(problem, parameters, {});
    integrate::OdeOptions options;
    options.method = integrate::Method::adams;
    options.rtol = 1e-11;
    options.atol = 1e-12;
    const double times[] = {problem.t_end};
    const auto run = integrate::solve_with_sensitivities(sensitive, options, times);
    REQUIRE(run.solution.status.ok());
    const auto end = [&](Parameter p, double shift) {
        RodProblem moved = problem;
        value(moved, p) += shift;
        RodOptions tight;
        tight.ode.rtol = 1e-12;
        return simulate(moved, tight).solution.final_state;
    };
    for (Eigen::Index k = 0; k < 3; ++k) {
        constexpr double h = 1e-2;
        const Parameter p = parameters[k];
        const auto p1 = end(p, h), m1 = end(p, -h), p2 = end(p, 2 * h), m2 = end(p, -2 * h);
        for (std::size_t i = 0; i < 6; ++i) {
            const double slope = (8.0 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12.0 * h);
            CHECK(run.final_sensitivity(static_cast<Eigen::Index>(i), k) ==
                  Approx(slope).epsilon(0.0).margin(1e-6)); // h^4 times the fifth derivative, some 100
        }
    }
}
