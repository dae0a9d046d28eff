// Rods that turn to the medium's velocity, and into the rows of a crystal.

#include "rods/interaction.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/periodic_table.hpp"
#include "rodwake/elastic/plane_table.hpp"
#include "rodwake/rods/noise.hpp"
#include "rodwake/rods/pair_batch.hpp"
#include "rodwake/rods/sensitivity.hpp"
#include "rodwake/rods/simulate.hpp"
#include "tests/elastic/measured_samples.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::rods;
using namespace measured_samples;

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
    for (const Formulation form : {Formulation::angle, Formulation::director, Formulation::dae}) {
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

// --- Rods in a measured field: in one that was sampled from an exact field they go as in that field

namespace {

/// Two rods that turn towards each other where data alone count.
rods::RodProblem pair_in(std::shared_ptr<const elastic::WakeField> field) {
    rods::RodProblem problem;
    problem.medium = field->medium();
    problem.box = field->box();
    problem.couplings = {4.0, 0.0, 0.0};
    problem.rods = {{0.0, 3.2, 0.0}, {0.5, -3.2, 0.0}};
    problem.t_end = 6.0;
    problem.field = std::move(field);
    return problem;
}

std::vector<double> end_of(const rods::RodProblem& problem,
                           integrate::Method method = integrate::Method::erk) {
    rods::RodOptions options;
    options.ode.method = method;
    const auto result = rods::simulate(problem, options);
    REQUIRE(result.solution.status.ok());
    return result.solution.final_state;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

} // namespace

TEST_CASE("rods in the samples of an exact field go as in that field") {
    const MeasuredDisplacement measured(sampled(48, 1e-6, false), theory, options());
    const auto end = end_of(pair_in(measured.field(box)));
    const auto exact = end_of(pair_in(exact_field(truth, box)));
    const auto by_theory = end_of(pair_in(exact_field(theory, box)));
    CHECK(largest_difference(by_theory, exact) > 0.05); // what data have to make up for
    // strain to 3e-3 (test_measured_field.cpp), where theory is off by 0.3 of it; and what data have beyond
    // theory's images does not turn with the rods, here by 0.1 rad
    CHECK(largest_difference(end, exact) < 0.05 * largest_difference(by_theory, exact));
}

TEST_CASE("the Jacobian of rods in a measured field is that of their right-hand side") {
    const auto field = MeasuredDisplacement(sampled(24, 0.02, true), theory, options(0.1)).field(box);
    const rods::RodModel model(field, {2.0, 0.5, -0.3}, 3);
    const std::vector<double> y = {0.0, 0.0, 0.3, 6.0, 2.5, 2.0, 1.5, 21.0, -1.0};
    Eigen::MatrixXd jacobian(9, 9);
    model.jacobian(y, jacobian);
    constexpr double h = 1e-5;
    std::vector<double> up(9), down(9);
    for (std::size_t j = 0; j < 9; ++j) {
        std::vector<double> a = y, b = y;
        a[j] += h;
        b[j] -= h;
        model.rhs(a, up);
        model.rhs(b, down);
        for (std::size_t i = 0; i < 9; ++i) // h^2/6 times third derivatives of order 10, rounding 1e-16/h
            CHECK(jacobian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) ==
                  Approx((up[i] - down[i]) / (2.0 * h)).margin(1e-7).epsilon(1e-6));
    }
    CHECK(largest_difference(end_of(pair_in(field)), end_of(pair_in(field), integrate::Method::bdf)) < 1e-4);
}

// --- Trajectories in a tabulated field against those in the exact one

namespace {

double worst(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = a.size() == b.size() ? 0.0 : HUGE_VAL;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

rods::RodProblem crossing(double start) {
    rods::RodProblem problem;
    problem.medium = elastic::Medium{.eta = 1.3, .xi = 2.0};
    problem.couplings = {.kappa = 1.5, .gamma1 = 0.3, .gamma2 = -0.2};
    problem.rods = {{0.0, 2.0, 0.0}, {start, -2.0, 0.5}};
    problem.t_end = 8.0;
    return problem;
}

} // namespace

TEST_CASE("trajectories in a table of tolerance T agree with the exact ones to 100 T") {
    for (const double tolerance : {1e-3, 1e-5}) {
        const auto table =
            std::make_shared<const elastic::PlaneTable>(elastic::make_plane_table(1.3, tolerance, 2));
        for (const double start : {-1.0, 0.5, 3.0})
            for (const auto method : {integrate::Method::erk, integrate::Method::bdf}) {
                rods::RodProblem problem = crossing(start);
                rods::RodOptions options;
                options.ode.method = method;
                options.ode.rtol = 0.1 * tolerance;
                const auto exact = rods::simulate(problem, options);
                problem.field = elastic::table_field(table, *problem.medium);
                const auto from_table = rods::simulate(problem, options);
                REQUIRE(from_table.solution.status.ok());
                const double off = worst(exact.solution.final_state, from_table.solution.final_state);
                CAPTURE(tolerance, start, off);
                CHECK(off <= 100.0 * tolerance);
                CHECK(off > 0.0); // it did come from the table
            }
    }
}

TEST_CASE("in a periodic box too, Jacobian and sensitivities of the table included") {
    rods::RodProblem problem = crossing(0.5);
    problem.box = 9.0;
    const auto exact = rods::model_of(problem);
    rods::RodOptions options;
    options.ode.rtol = 1e-8;
    const auto truth = rods::simulate(problem, options);
    problem.field = elastic::table_field(elastic::PeriodicTable(*problem.medium, 9.0, 1e-8, 2));
    const auto from_table = rods::simulate(problem, options);
    CHECK(worst(truth.solution.final_state, from_table.solution.final_state) < 1e-6); // 100 T
    const auto y = rods::to_state(problem.rods);
    std::vector<double> a(6), b(6);
    exact.rhs(y, a);
    rods::model_of(problem).rhs(y, b);
    CHECK(worst(a, b) < 1e-7); // couplings of order 1, strain and second derivatives of order 0.1
    CHECK(worst(a, b) > 0.0);
    Eigen::MatrixXd by_exact(6, 6), by_table(6, 6);
    exact.jacobian(y, by_exact);
    rods::model_of(problem).jacobian(y, by_table);
    CHECK((by_exact - by_table).cwiseAbs().maxCoeff() < 1e-5); // derivatives by heading 1e-6 of the largest
}

TEST_CASE("a field of another medium or domain is refused") {
    rods::RodProblem problem = crossing(1.0);
    problem.field = elastic::exact_field({.eta = 1.3, .xi = 2.5});
    CHECK_THROWS_AS(rods::simulate(problem, {}), InputError);
    problem.field = elastic::exact_field(*problem.medium, 30.0);
    CHECK_THROWS_AS(rods::simulate(problem, {}), InputError);
    problem.box = 30.0;
    CHECK_NOTHROW(rods::wakes_of(problem));
}
