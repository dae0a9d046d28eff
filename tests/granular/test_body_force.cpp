// A force on the beads: against closed forms, its momentum, its order, and that it waits for t = 0.

#include "beds.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

const double a = GranularProblem{}.bead_radius;

/// Plates without friction, losses between beads: momentum along the plates changes by the force alone.
GranularProblem smooth_gas(const BodyForce& force) {
    GranularProblem problem = beds::still_plates(1.2e-3, {60 * a, 40 * a});
    beds::set_contacts(problem, {0.0, 0.9});
    problem.contacts.bead_bead = {0.3, 0.8};
    problem.beads = 300;
    problem.start_speed = 0.05;
    problem.body_force = force;
    return problem;
}

Eigen::Vector2d mean_velocity(const State& state) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < state.beads.size(); ++i)
        sum += Eigen::Vector2d(state.beads.vx[i], state.beads.vy[i]);
    return sum / static_cast<double>(state.beads.size());
}

/// Mean over the beads of what the force gives.
Eigen::Vector2d mean_push(const State& state, const GranularProblem& problem, double time) {
    const BodyForce& force = *problem.body_force;
    double sum = 0.0;
    for (std::size_t i = 0; i < state.beads.size(); ++i)
        sum += force.at(state.beads.x[i], state.beads.y[i], time, problem.box);
    return sum / static_cast<double>(state.beads.size()) *
           Eigen::Vector2d(std::cos(force.direction), std::sin(force.direction));
}

BodyForce gaussian(double acceleration, double direction, double width, double speed, double x, double y) {
    return {BodyForceKind::gaussian, acceleration, direction, width, speed, {x, y}};
}

/// Where one bead between plates far apart is after 0.1 s beside a Gaussian, and how fast, in steps of that
/// length.
Eigen::Vector4d pushed_bead(double step) {
    GranularProblem problem = beds::still_plates(0.5, 100 * a);
    problem.beads = 1;
    problem.time_step = step;
    problem.body_force = gaussian(2.0, 0.6, 8 * a, 0.05, 48 * a, 47 * a);
    State state = beds::one_bead(0.25, 0.0);
    state.beads.x[0] = state.beads.y[0] = 50 * a;
    state.beads.vx[0] = -0.02;
    Simulation run(problem, state);
    run.advance(whole_steps(0.1, step));
    const State end = run.state();
    return {end.beads.x[0], end.beads.y[0], end.beads.vx[0], end.beads.vy[0]};
}

} // namespace

TEST_CASE("the Gaussian is what it says, across the edges too") {
    const PeriodicBox box{80 * a, 50 * a};
    const BodyForce force = gaussian(3.0, 0.5 * M_PI, 4 * a, 0.02, 1 * a, 49 * a);
    CHECK(force.at(1 * a, 49 * a, 0.0, box) == 3.0);
    const double time = 0.1, y = 49 * a + 0.002; // it went 2 mm along y, round the edge
    CHECK(force.at(79 * a, y - box.y, time, box) ==
          Approx(3.0 * std::exp(-0.5 * 4.0 / 16.0)).epsilon(1e-12)); // 2 a away; rounding
    CHECK(force.at(1 * a + 8 * box.x, y + 6 * a, time, box) ==
          Approx(3.0 * std::exp(-0.5 * 36.0 / 16.0)).epsilon(1e-12));
    CHECK(force.at(41 * a, y, time, box) < 3.0 * std::exp(-0.5 * 40.0 * 40.0 / 16.0) + 1e-15);
}

TEST_CASE("a uniform force moves the centre of mass of a gas as it moves a point") {
    const BodyForce force{BodyForceKind::uniform, 0.4, 2.1};
    GranularProblem problem = smooth_gas(force);
    problem.equilibration_steps = 100;
    Simulation run(problem, make_start(problem, 0), {}, 2);
    run.advance(100);
    const Eigen::Vector2d before = mean_velocity(run.state());
    CHECK(before.norm() < 1e-15); // not before t = 0: starts have no momentum
    run.advance(1500);
    CHECK_FALSE(run.failure());
    CHECK(run.tallies().bead_bead > 100);
    const double time = 1500 * problem.time_step;
    const Eigen::Vector2d wanted = force.acceleration * time * Eigen::Vector2d(std::cos(2.1), std::sin(2.1));
    CHECK((mean_velocity(run.state()) - wanted).norm() < 1e-12 * wanted.norm()); // rounding of 1500 additions
}

TEST_CASE("a moving Gaussian gives the beads the momentum of its kicks") {
    GranularProblem problem = smooth_gas(gaussian(5.0, 0.3, 4 * a, 0.3, 30 * a, 20 * a));
    Simulation run(problem, make_start(problem, 0));
    Eigen::Vector2d given = Eigen::Vector2d::Zero();
    for (int k = 0; k < 600; ++k) {
        given += 0.5 * problem.time_step * mean_push(run.state(), problem, run.time());
        run.advance(1);
        given += 0.5 * problem.time_step * mean_push(run.state(), problem, run.time());
    }
    CHECK(run.tallies().bead_bead > 50);
    CHECK(given.norm() > 1e-4); // m/s
    CHECK((mean_velocity(run.state()) - given).norm() < 1e-12 * given.norm());
}

TEST_CASE("the error of a bead pushed by a Gaussian falls as the square of the step") {
    const Eigen::Vector4d exact = pushed_bead(1e-5);
    const double coarse = (pushed_bead(8e-4) - exact).norm(), fine = (pushed_bead(4e-4) - exact).norm();
    CHECK(coarse > 1e-9);                              // not rounding
    CHECK(coarse / fine == Approx(4.0).epsilon(0.05)); // terms of order 4, and the reference's 1/1600
}

TEST_CASE("a body force that is none changes no bit, one that is goes on with the same bits") {
    GranularProblem problem = smooth_gas({BodyForceKind::uniform, 0.0, 0.0}), none = problem;
    none.body_force.reset();
    const State start = make_start(none, 0);
    Simulation with(problem, start), without(none, start);
    with.advance(300);
    without.advance(300);
    CHECK(state_hash(with.state()) == state_hash(without.state()));
    problem.body_force = gaussian(5.0, 0.3, 4 * a, 0.3, 30 * a, 20 * a);
    Simulation whole(problem, start, {}, 1), first(problem, start, {}, 3);
    whole.advance(300);
    first.advance(140);
    Simulation second(problem, first.state(), first.tallies(), 2);
    second.advance(160);
    CHECK(state_hash(whole.state()) == state_hash(second.state()));
    CHECK(state_hash(whole.state()) != state_hash(without.state()));
}

TEST_CASE("a body force that cannot be is refused by name") {
    const auto refused = [](const BodyForce& force, const char* words) {
        GranularProblem problem = smooth_gas(force);
        CHECK_THROWS_WITH(validate(problem), Catch::Contains("body_force: ") && Catch::Contains(words));
    };
    refused({BodyForceKind::uniform, NAN, 0.0}, "acceleration");
    refused({BodyForceKind::uniform, 1.0, INFINITY}, "direction");
    refused({BodyForceKind::gaussian, 1.0, 0.0, 4.1 * a}, "a tenth of the box's shorter side");
    refused({BodyForceKind::gaussian, 1.0, 0.0, 0.0}, "width");
    refused({BodyForceKind::gaussian, 1.0, 0.0, a, NAN}, "speed");
    refused({BodyForceKind::gaussian, 1.0, 0.0, a, 0.0, {1.0}}, "must have 2");
    refused({BodyForceKind::gaussian, 1.0, 0.0, a, 0.0, {NAN, 0.0}}, "position");
}
