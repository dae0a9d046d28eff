// Rods with bodies: rates and derivatives against a plain loop over all discs, runs against fixed steps of
// it, outcomes, records and refusals.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/noise.hpp"
#include "rodwake/rods/pair_batch.hpp"
#include "rodwake/rods/sensitivity.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

using State = std::vector<double>;

/// The equations of rods/body.hpp as they stand there, over all pairs of discs: rates without wakes.
State plain_rates(const RodBodies& bodies, const State& y, Box box = {}) {
    const std::size_t rods = y.size() / 3;
    const double strength = std::pow(bodies.stall_overlap, -1.5), b = bodies.mobility_ratio;
    State rates(y.size(), 0.0);
    for (std::size_t i = 0; i < rods; ++i) {
        const BodyShape& own = bodies.of(i);
        const double nx = std::cos(y[3 * i + 2]), ny = std::sin(y[3 * i + 2]);
        double fx = 0.0, fy = 0.0, torque = 0.0;
        for (std::size_t j = 0; j < rods; ++j) {
            const BodyShape& other = bodies.of(j);
            for (std::size_t k = 0; i != j && k < own.spheres; ++k)
                for (std::size_t m = 0; m < other.spheres; ++m) {
                    const auto disc = [](const BodyShape& shape, std::size_t at) {
                        const double r0 = shape.thick_diameter / 2.0, r1 = shape.thin_diameter / 2.0;
                        const double u = shape.spheres == 1 ? 0.5
                                                            : static_cast<double>(at) /
                                                                  static_cast<double>(shape.spheres - 1);
                        return std::pair((u - 0.5) * (shape.length - r0 - r1), r0 + (r1 - r0) * u);
                    };
                    const auto [sk, rk] = disc(own, k);
                    const auto [sm, rm] = disc(other, m);
                    double dx = y[3 * i] - y[3 * j], dy = y[3 * i + 1] - y[3 * j + 1];
                    if (box) {
                        dx -= box->x * std::round(dx / box->x);
                        dy -= box->y * std::round(dy / box->y);
                    }
                    dx += sk * nx - sm * std::cos(y[3 * j + 2]);
                    dy += sk * ny - sm * std::sin(y[3 * j + 2]);
                    const double d = std::hypot(dx, dy), delta = 1.0 - d / (rk + rm);
                    if (delta <= 0.0)
                        continue;
                    const double force = strength * std::pow(delta, 1.5);
                    fx += force * dx / d;
                    fy += force * dy / d;
                    torque += sk * (nx * force * dy / d - ny * force * dx / d);
                }
        }
        const double along = fx * nx + fy * ny, across = -fx * ny + fy * nx;
        rates[3 * i] = nx + along * nx - b * across * ny;
        rates[3 * i + 1] = ny + along * ny + b * across * nx;
        rates[3 * i + 2] = 12.0 / (own.length * own.length) * torque;
    }
    return rates;
}

/// The same with the wakes of the exact field.
State plain_rates(const RodProblem& problem, const State& y) {
    State rates = plain_rates(problem.bodies, y, problem.box);
    RodProblem points = problem;
    points.bodies = {};
    State wakes(y.size());
    model_of(points).rhs(y, wakes);
    for (std::size_t i = 2; i < y.size(); i += 3)
        rates[i] += wakes[i];
    return rates;
}

/// Classical Runge-Kutta steps of order 4.
State by_fixed_steps(const RodProblem& problem, long steps) {
    State y = to_state(problem.rods);
    const double h = problem.t_end / static_cast<double>(steps);
    const auto moved = [&](const State& from, const State& rates, double by) {
        State to = from;
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] += by * rates[i];
        return to;
    };
    for (long n = 0; n < steps; ++n) {
        const State k1 = plain_rates(problem, y), k2 = plain_rates(problem, moved(y, k1, 0.5 * h)),
                    k3 = plain_rates(problem, moved(y, k2, 0.5 * h)),
                    k4 = plain_rates(problem, moved(y, k3, h));
        for (std::size_t i = 0; i < y.size(); ++i)
            y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
    return y;
}

double worst_difference(const State& a, const State& b) {
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::max(worst, std::abs(a[i] - b[i]));
    return worst;
}

const BodyShape long_rod{8, 1.6, 0.34, 0.22};

/// Rods close enough that some discs overlap.
State crowd(RandomStream& random, std::size_t rods, double side) {
    State y;
    for (std::size_t a = 0; a < rods; ++a)
        y.insert(y.end(), {random.uniform(0.0, side), random.uniform(0.0, side), random.uniform(-3.1, 3.1)});
    return y;
}

/// Two rods that meet at an angle; the wakes of the second case turn them meanwhile.
RodProblem crossing(bool wakes) {
    RodProblem problem;
    if (wakes) {
        problem.medium = elastic::Medium{1.0, 1.0};
        problem.couplings.kappa = 2.0;
    }
    problem.bodies.shapes = {BodyShape{}};
    problem.rods = {{0.0, 0.0, 0.2}, {1.6, -1.3, 1.7}};
    problem.t_end = 4.0;
    return problem;
}

RodProblem head_on(double aside) {
    RodProblem problem;
    problem.bodies.shapes = {BodyShape{}};
    problem.rods = {{0.0, 0.0, 0.0}, {3.0, aside, std::numbers::pi}};
    problem.t_end = 40.0;
    return problem;
}

RodOptions options_of(integrate::Method method, double rtol, Formulation form = Formulation::angle) {
    RodOptions options;
    options.ode.method = method;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    options.form = form;
    return options;
}

} // namespace

TEST_CASE("rates of bodies are those of a loop over all discs, and add up to nothing") {
    RandomStream random(11);
    RodBodies bodies;
    bodies.shapes = {BodyShape{}, long_rod, BodyShape{1, 0.4, 0.4, 0.4}, long_rod, BodyShape{}};
    for (const double b : {1.0, 0.3})
        for (const bool in_box : {false, true})
            for (int i = 0; i < 100; ++i) {
                bodies.mobility_ratio = b;
                const double side = in_box ? 3.4 : 2.0;
                const Box box = in_box ? Box(PeriodicBox(side)) : std::nullopt;
                const State y = crowd(random, 5, side);
                State rates(y.size());
                RodModel(nullptr, {}, 5, {}, BodyForces(bodies, 5, box)).rhs(y, rates);
                const State expected = plain_rates(bodies, y, box);
                double largest = 1.0;
                for (const double rate : expected)
                    largest = std::max(largest, std::abs(rate));
                CHECK(worst_difference(rates, expected) < 1e-12 * largest); // rounding of some dozen terms
                if (b != 1.0)
                    continue;
                double x = 0.0; // with friction that has no direction velocities are forces
                for (std::size_t a = 0; a < 5; ++a)
                    x += rates[3 * a] - std::cos(y[3 * a + 2]);
                CHECK(std::abs(x) < 1e-13 * largest);
            }
}

/// Gap and largest overlap of two rods, over all pairs of discs.
BodyContact plain_contact(const BodyShape& own, const BodyShape& other, const State& y, std::size_t a,
                          std::size_t b) {
    BodyContact found{a, b, 1e9, -1e9};
    for (std::size_t k = 0; k < own.spheres; ++k)
        for (std::size_t m = 0; m < other.spheres; ++m) {
            const auto disc = [&](const BodyShape& shape, std::size_t rod, std::size_t at) {
                const double r0 = shape.thick_diameter / 2.0, r1 = shape.thin_diameter / 2.0;
                const double u = shape.spheres == 1
                                     ? 0.5
                                     : static_cast<double>(at) / static_cast<double>(shape.spheres - 1);
                const double along = (u - 0.5) * (shape.length - r0 - r1);
                return std::array{y[3 * rod] + along * std::cos(y[3 * rod + 2]),
                                  y[3 * rod + 1] + along * std::sin(y[3 * rod + 2]), r0 + (r1 - r0) * u};
            };
            const auto [x, up, r] = disc(own, a, k);
            const auto [to_x, to_up, other_r] = disc(other, b, m);
            const double apart = std::hypot(x - to_x, up - to_up);
            found.gap = std::min(found.gap, apart - r - other_r);
            found.overlap = std::max(found.overlap, 1.0 - apart / (r + other_r));
        }
    return found;
}

TEST_CASE("rows of many discs, of strong taper and in crowds: forces and gaps of the loop over all discs") {
    RandomStream random(3);
    const BodyShape disc{1, 0.4, 0.4, 0.4},
        cone{60, 1.3, 1.0, 0.02}; // whose radii fall almost as places grow
    for (const BodyShape& own : {disc, BodyShape{5, 1.0, 0.35, 0.3}, BodyShape{40, 1.25, 0.3, 0.2},
                                 BodyShape{300, 1.25, 0.3, 0.01}, cone})
        for (const BodyShape& other : {BodyShape{}, disc, cone}) {
            RodBodies bodies;
            bodies.shapes = {own, other};
            const BodyForces forces(bodies, 2, {});
            for (int i = 0; i < 60; ++i) {
                State y = crowd(random, 2, i % 2 == 0 ? 0.9 : 2.5);
                if (i % 10 == 0) // side by side, and one behind the other
                    y[5] = y[2] + (i % 20 == 0 ? std::numbers::pi : 0.0);
                State rates(6, 0.0), expected = plain_rates(bodies, y);
                RodModel(nullptr, {}, 2, {}, forces).rhs(y, rates);
                double largest = 1.0;
                for (const double rate : expected)
                    largest = std::max(largest, std::abs(rate));
                CHECK(worst_difference(rates, expected) < 1e-12 * largest);
                const BodyContact found = forces.contact(y, 0, 1), all = plain_contact(own, other, y, 0, 1);
                CHECK(std::abs(found.gap - all.gap) < 1e-12);
                CHECK(std::abs(found.overlap - all.overlap) < 1e-12 * (1.0 + std::abs(all.overlap)));
            }
        }
    const RodBodies bodies{{BodyShape{}}};
    for (const double side : {7.0, 30.0}) { // with overlaps, and almost without
        const State y = crowd(random, 60, side);
        const BodyForces forces(bodies, 60, {}), in_box(bodies, 60, PeriodicBox(side));
        State rates(y.size()), rates_in_box(y.size());
        RodModel(nullptr, {}, 60, {}, forces).rhs(y, rates);
        RodModel(nullptr, {}, 60, {}, in_box).rhs(y, rates_in_box);
        CHECK(worst_difference(rates, plain_rates(bodies, y)) < 1e-11);
        CHECK(worst_difference(rates_in_box, plain_rates(bodies, y, PeriodicBox(side))) < 1e-11);
        double nearest = 1e9, limit = 1.0;
        for (std::size_t a = 0; a < 60; ++a)
            for (std::size_t b = a + 1; b < 60; ++b) {
                const double gap = plain_contact(BodyShape{}, BodyShape{}, y, a, b).gap;
                const double speed = 2.0 * std::abs(std::sin(0.5 * (y[3 * a + 2] - y[3 * b + 2])));
                nearest = std::min(nearest, gap);
                if (gap > 0.0)
                    limit = std::min(limit, (0.5 * gap + 0.05) / std::max(speed, 0.5));
            }
        CHECK(std::abs(forces.closest(y).gap - nearest) < 1e-12);
        CHECK(std::abs(forces.step_limit(y, 0.5) - limit) < 1e-12);
    }
}

TEST_CASE("wakes that are held change a run within its tolerance, in second order") {
    RandomStream random(21);
    RodProblem problem;
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.couplings.kappa = 2.0;
    problem.bodies.shapes = {BodyShape{}};
    for (int a = 0; a < 16; ++a) // on a grid, so that they start apart and meet soon
        problem.rods.push_back({1.5 * (a % 4) + random.uniform(-0.1, 0.1),
                                1.5 * (a / 4) + random.uniform(-0.1, 0.1), random.uniform(-3.1, 3.1)});
    const BodyForces forces(problem.bodies, 16, {});
    REQUIRE(forces.closest(to_state(problem.rods)).gap > 0.0);
    problem.output_times = {0.0, 0.3, 0.7};
    problem.t_end = 1.0;
    const State exact = simulate(problem, options_of(integrate::Method::erk, 1e-10)).solution.final_state;
    double before = 0.0;
    for (const double rtol : {1e-3, 1e-5, 1e-7}) {
        RodOptions options = options_of(integrate::Method::erk, rtol);
        options.held_wakes = true;
        std::vector<RodCheckpoint> checkpoints;
        options.on_checkpoint = [&](const RodCheckpoint& checkpoint) { checkpoints.push_back(checkpoint); };
        const RodResult run = simulate(problem, options);
        REQUIRE(run.solution.status.ok());
        CHECK(run.solution.times == std::vector{0.0, 0.3, 0.7, 1.0});
        CHECK(run.outcome.min_gap < 0.0); // they did touch
        const double error = worst_difference(run.solution.final_state, exact);
        CHECK(error < 100.0 * rtol);
        CHECK((before == 0.0 || error < 0.1 * before));
        before = error;
        if (rtol > 1e-7) // too few long steps for a segment
            continue;
        REQUIRE(!checkpoints.empty());
        options.resume_from = checkpoints[checkpoints.size() / 2];
        CHECK(simulate(problem, options).solution.final_state == run.solution.final_state);
    }
    CHECK(!suits_held_wakes(problem)); // too few of them
}

TEST_CASE("derivatives of bodies are those of differences") {
    RandomStream random(5);
    RodBodies bodies;
    bodies.shapes = {BodyShape{}, long_rod, BodyShape{}};
    bodies.mobility_ratio = 0.4;
    RodProblem problem;
    problem.bodies = bodies;
    problem.medium = elastic::Medium{2.0, 0.7};
    problem.couplings = {3.0, 0.5, -0.2};
    problem.rods.resize(3);
    const RodModel model = model_of(problem);
    for (int i = 0; i < 50; ++i) {
        const State y = crowd(random, 3, 1.5);
        if (closest_pair(y).distance < 0.3) // the field, too, varies too fast for differences
            continue;
        Eigen::MatrixXd analytic(9, 9), both(9, 9), differences(9, 9);
        model.jacobian(y, analytic);
        State rates(9), again(9), up(9), down(9);
        model.rhs(y, rates);
        model.linearise(y, again, both);
        CHECK(worst_difference(rates, again) < 1e-12 * (1.0 + analytic.cwiseAbs().maxCoeff()));
        CHECK((analytic - both).cwiseAbs().maxCoeff() < 1e-12 * analytic.cwiseAbs().maxCoeff());
        constexpr double h = 1e-6; // their error is h^2 times third derivatives, and rounding over h
        for (Eigen::Index column = 0; column < 9; ++column) {
            State moved = y;
            moved[static_cast<std::size_t>(column)] += h;
            model.rhs(moved, up);
            moved[static_cast<std::size_t>(column)] -= 2.0 * h;
            model.rhs(moved, down);
            for (Eigen::Index row = 0; row < 9; ++row)
                differences(row, column) =
                    (up[static_cast<std::size_t>(row)] - down[static_cast<std::size_t>(row)]) / (2.0 * h);
        }
        CHECK((analytic - differences).cwiseAbs().maxCoeff() < 2e-5 * analytic.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("a rod that walks head on against a fixed disc stops at stall_overlap") {
    RodBodies bodies;
    bodies.shapes = {BodyShape{}, BodyShape{1, 0.5, 0.5, 0.5}};
    const BodyForces forces(bodies, 2, std::nullopt);
    integrate::OdeProblem ode;
    ode.initial_state = {0.0, 0.0, 0.0, 2.0, 0.0, 0.0};
    ode.rhs = [&](double, integrate::State y, std::span<double> ydot) {
        std::ranges::fill(ydot, 0.0);
        ydot[0] = std::cos(y[2]);
        ydot[1] = std::sin(y[2]);
        forces.add_rates(y, ydot);
        std::fill(ydot.begin() + 3, ydot.end(), 0.0);
    };
    ode.step_limit = [&](double, integrate::State y) { return forces.step_limit(y, 0.5); };
    integrate::OdeOptions options;
    options.method = integrate::Method::bdf;
    options.rtol = options.atol = 1e-12;
    const double times[] = {20.0};
    const State end = integrate::solve(ode, options, times).final_state;
    CHECK(std::abs(forces.contact(end, 0, 1).overlap - bodies.stall_overlap) < 1e-8);
}

TEST_CASE("runs with bodies follow fixed steps, in all methods and forms") {
    using integrate::Method;
    for (const bool wakes : {false, true}) {
        const RodProblem problem = crossing(wakes);
        // Halving the steps changes the state by 2e-10.
        const State expected = by_fixed_steps(problem, 20000);
        CHECK(RodModel(nullptr, {}, 2, {}, BodyForces(problem.bodies, 2, {})).bodies().closest(expected).gap <
              10.0);
        using enum Formulation;
        const std::pair<Method, Formulation> ways[] = {{Method::erk, angle},    {Method::bdf, angle},
                                                       {Method::adams, angle},  {Method::erk, director},
                                                       {Method::bdf, director}, {Method::bdf, dae}};
        for (const auto& [method, form] : ways) {
            const RodResult run = simulate(problem, options_of(method, 1e-9, form));
            REQUIRE(run.solution.status.ok());
            CHECK(worst_difference(run.solution.final_state, expected) < 1e-6);
            CHECK(run.outcome.min_gap < 0.0); // they did touch
        }
    }
}

TEST_CASE("the order of rods and the frame do not matter to bodies") {
    RodProblem problem = crossing(true);
    problem.rods.push_back({0.6, 1.4, -1.2});
    const RodOptions options = options_of(integrate::Method::erk, 1e-12);
    const State plain = simulate(problem, options).solution.final_state;
    RodProblem other = problem;
    constexpr double turn = 0.83, x = 3.1, y = -2.2;
    const auto moved = [&](const Pose& rod) {
        return Pose{x + std::cos(turn) * rod.x - std::sin(turn) * rod.y,
                    y + std::sin(turn) * rod.x + std::cos(turn) * rod.y, rod.heading + turn};
    };
    std::ranges::reverse(other.rods);
    for (Pose& rod : other.rods)
        rod = moved(rod);
    const State turned = simulate(other, options).solution.final_state;
    for (std::size_t a = 0; a < 3; ++a) {
        const Pose expected = moved(pose(plain, a)), got = pose(turned, 2 - a);
        CHECK(std::abs(expected.x - got.x) < 1e-9);
        CHECK(std::abs(expected.y - got.y) < 1e-9);
        CHECK(std::abs(expected.heading - got.heading) < 1e-9);
    }
}

TEST_CASE("rods that push each other are bound, rods that slid apart are not") {
    const RodOptions options = options_of(integrate::Method::bdf, 1e-9);
    RodProblem problem = head_on(0.0);
    problem.t_end = 1.5; // later rounding has grown, by exp(20 t), and turns them aside
    const RodResult stalled = simulate(problem, options);
    CHECK(stalled.outcome.ending == Ending::bound);
    CHECK(is_capture(stalled.outcome.ending));
    // The thin ends overlap by 0.05 of the sum of their radii, and both rods walk, so each disc feels a rod.
    CHECK(stalled.outcome.min_gap == Approx(-0.05 * 0.2).epsilon(1e-6));
    CHECK(stalled.outcome.separation == Approx(1.2 - 0.01).epsilon(1e-6));
    CHECK(stalled.outcome.certificate == Certificate::open);

    const RodResult slid = simulate(head_on(0.15), options);
    CHECK(slid.outcome.ending == Ending::escape);
    CHECK(slid.outcome.min_gap < 0.0);

    RodProblem near = head_on(0.0); // contact comes before all others
    near.contact_distance = 1.3;
    CHECK(simulate(near, options).outcome.ending == Ending::contact);

    // Rods that pass at a distance: their thick ends are nearest to each other's thin ones.
    RodProblem apart = head_on(0.9);
    apart.t_end = 8.0;
    const RodResult passed = simulate(apart, options);
    CHECK(passed.outcome.min_gap > 0.6);
    CHECK(passed.outcome.min_separation == Approx(0.9).epsilon(1e-6));
}

TEST_CASE("runs with bodies go on from a checkpoint to the bit") {
    const RodProblem problem = head_on(0.15);
    RodOptions options = options_of(integrate::Method::erk, 1e-9);
    options.ode.segment_steps = 200;
    std::vector<RodCheckpoint> checkpoints;
    options.on_checkpoint = [&](const RodCheckpoint& checkpoint) { checkpoints.push_back(checkpoint); };
    const RodResult whole = simulate(problem, options);
    REQUIRE(checkpoints.size() > 1);
    options.resume_from = checkpoints[checkpoints.size() / 2];
    const RodResult rest = simulate(problem, options);
    CHECK(rest.solution.final_state == whole.solution.final_state);
    CHECK(rest.outcome.min_gap == whole.outcome.min_gap);
    CHECK(rest.record.bodies.touching == whole.record.bodies.touching);
}

TEST_CASE("sensitivities go through contacts of bodies") {
    const RodProblem problem = crossing(true);
    const Parameter parameters[] = {Parameter::kappa};
    const std::size_t headings[] = {1};
    const integrate::SensitivityProblem sensitive = to_sensitivity_problem(problem, parameters, headings);
    integrate::OdeOptions options;
    options.method = integrate::Method::bdf;
    options.rtol = 1e-11;
    options.atol = 1e-12;
    const double times[] = {problem.t_end};
    const auto solved = integrate::solve_with_sensitivities(sensitive, options, times);
    constexpr double h = 1e-4; // the error of the differences is h^2 times third derivatives of some 1e2
    for (Eigen::Index column : {0, 1}) {
        const auto end = [&](double by) {
            RodProblem moved = problem;
            (column == 0 ? moved.couplings.kappa : moved.rods[1].heading) += by;
            return simulate(moved, options_of(integrate::Method::erk, 1e-12)).solution.final_state;
        };
        const State up = end(h), down = end(-h);
        for (std::size_t i = 0; i < 6; ++i)
            CHECK(std::abs((up[i] - down[i]) / (2.0 * h) -
                           solved.final_sensitivity(static_cast<Eigen::Index>(i), column)) < 1e-4);
    }
}

TEST_CASE("rods with bodies and noise keep apart, and take no batch") {
    RodProblem problem = crossing(true);
    CHECK(!to_pair_problem(problem));
    Noise noise;
    noise.rotational = 0.05;
    noise.translational = 0.001;
    noise.time_step = 0.02;
    const RodResult run = simulate(problem, {}, noise, 0);
    CHECK(run.solution.status.ok());
    CHECK(run.outcome.min_gap > -0.1);
    noise.rotational = noise.translational = 0.0; // then it is the smooth run, to the order of its steps
    noise.time_step = 0.002;
    const State smooth = simulate(problem, options_of(integrate::Method::erk, 1e-9)).solution.final_state;
    CHECK(worst_difference(simulate(problem, {}, noise, 0).solution.final_state, smooth) < 1e-3);
}

TEST_CASE("illegal bodies are refused with the option and the range") {
    const auto message = [](const BodyShape& shape) {
        const auto fault = fault_of(shape);
        return fault ? std::string(fault->option) + " " + fault->message : std::string();
    };
    CHECK_THAT(message({2, 1.25, 0.3, 0.2}), Catch::Contains("spheres is 2: must be 1 or 3 to 1000"));
    CHECK_THAT(message({5, 1.25, 0.3, 0.2}), Catch::Contains("spheres is 5: leaves gaps"));
    CHECK_THAT(message({6, 1.25, 0.2, 0.3}), Catch::Contains("thin_diameter is 0.3"));
    CHECK_THAT(message({6, 0.2, 0.3, 0.2}), Catch::Contains("length is 0.2"));
    CHECK_THAT(message({1, 1.25, 0.3, 0.2}), Catch::Contains("spheres is 1"));
    CHECK(message({1, 0.3, 0.3, 0.3}).empty());
    RodProblem problem = head_on(0.0);
    problem.rods[1].x = 1.15; // the tips are 0.6 before the centres
    CHECK_THROWS_WITH(simulate(problem, {}), Catch::Contains("overlap by 0.05 at the start"));
    problem.rods[1].x = 0.1; // one inside the other
    CHECK_THROWS_AS(simulate(problem, {}), InputError);
    problem = head_on(0.0);
    problem.box = PeriodicBox(2.4);
    CHECK_THROWS_WITH(simulate(problem, {}), Catch::Contains("must exceed 2.5"));
    problem.box.reset();
    problem.bodies.shapes.resize(3, BodyShape{});
    CHECK_THROWS_WITH(simulate(problem, {}), Catch::Contains("3 bodies for 2 rods"));
    problem.bodies = {{BodyShape{}}, 0.9, 1.0};
    CHECK_THROWS_WITH(simulate(problem, {}), Catch::Contains("stall_overlap = 0.9"));
}
