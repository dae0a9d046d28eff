// Hard cases, each with its outcome: it runs, or it stops with a message that says what to do.

#include "beds.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;
using Catch::Matchers::Contains;

namespace {

const double a = GranularProblem{}.bead_radius;

GranularProblem bed(double fraction, double side = 30.0) {
    GranularProblem problem;
    problem.box = side * a;
    problem.beads = static_cast<std::size_t>(std::floor(fraction * side * side / M_PI));
    return problem;
}

bool finite(const State& state) {
    const Beads& b = state.beads;
    for (const auto* numbers : {&b.x, &b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        for (const double x : *numbers)
            if (!std::isfinite(x))
                return false;
    for (const RodBody& rod : state.rods)
        if (!rod.position.allFinite() || !rod.velocity.allFinite() || !rod.orientation.coeffs().allFinite())
            return false;
    return true;
}

/// All beads between the plates, but for those that an impulse of the last step pushed into one.
bool between_plates(const Simulation& run) {
    const GranularProblem& p = run.problem();
    const double pushed = 0.1 * p.time_step; // at 0.1 m/s
    const double floor =
        p.plates.amplitude(p.gravity) * std::cos(2.0 * M_PI * p.plates.frequency * run.time());
    for (const double z : run.state().beads.z)
        if (z < floor + a - pushed || z > floor + p.plates.gap - a + pushed)
            return false;
    return true;
}

Simulation after(const GranularProblem& problem, double seconds) {
    Simulation run(problem, make_start(problem, 0));
    run.advance(std::lround(seconds / problem.time_step));
    CHECK(finite(run.state()));
    return run;
}

std::string stop_message(GranularProblem problem, double dt) {
    problem.time_step = dt;
    const Simulation run = after(problem, 0.5);
    return run.failure() ? run.failure()->message : "";
}

} // namespace

TEST_CASE("no rebound at all: the bed runs") {
    GranularProblem problem = bed(0.7);
    beds::set_contacts(problem, {0.2, 0.0});
    problem.rods.push_back(beds::long_rod(15 * a, 15 * a, 0.1));
    problem.beads = 150;
    const Simulation run = after(problem, 0.1);
    CHECK_FALSE(run.failure());
    CHECK(between_plates(run));
    CHECK(run.temperatures().z > 0.0);
}

TEST_CASE("what sank into each other without rebound is moved apart, once the bed has settled") {
    constexpr double sunk = 0.08, left = 0.05; // radii; what is left is `deep` of pair_contacts.cpp
    GranularProblem problem = beds::still_plates(3 * a, 30 * a);
    problem.overlap_limit = 0.1;
    problem.beads = 2;
    beds::set_contacts(problem, {0.2, 0.0});
    State state;
    state.beads.resize(2);
    state.beads.x = {10 * a, (12 - sunk) * a};
    state.beads.y = {10 * a, 10 * a};
    state.beads.z = {a, a};
    state.beads.vx = {1e-3, -1e-3};
    for (const bool settles : {true, false}) {
        problem.equilibration_steps = settles ? 500 : 0;
        Simulation run(problem, state);
        run.advance(400);
        const Beads after = run.state().beads;
        CAPTURE(settles);
        CHECK_FALSE(run.failure());
        // as deep as the first step took them, or no deeper than is left alone; to rounding
        const double least = settles ? 2 - sunk - 2e-3 * problem.time_step / a : 2 - left;
        CHECK(after.x[1] - after.x[0] == Approx(least * a).epsilon(1e-12));
        CHECK(after.x[0] + after.x[1] == Approx((22 - sunk) * a).epsilon(1e-12));
    }
}

TEST_CASE("full rebound, shaken: the bed heats up and runs, or stops with the guard's message") {
    GranularProblem problem = bed(0.7);
    beds::set_contacts(problem, {0.0, 1.0});
    const Simulation run = after(problem, 0.3);
    CHECK(run.temperatures().z > 1e-3);
    if (run.failure())
        CHECK_THAT(run.failure()->message, Contains("time_step"));
    else
        CHECK(between_plates(run));
}

TEST_CASE("weak and violent shaking run") {
    for (const double gamma : {0.0, 1.2, 20.0, 50.0}) {
        GranularProblem problem = bed(0.7);
        problem.plates.gamma = gamma;
        problem.time_step = problem.plates.longest_step(problem.gravity, problem.bead_radius);
        const Simulation run = after(problem, 0.1);
        CAPTURE(gamma);
        CHECK_FALSE(run.failure());
        CHECK(between_plates(run));
        CHECK(run.temperatures().xy >= 0.0);
        CHECK(run.temperatures().z >= 0.0);
        if (gamma == 0.0)
            CHECK(run.temperatures().z < 1e-10); // it came to rest on the floor; measured 1e-11
    }
}

TEST_CASE("nearly empty and nearly close-packed beds run") {
    for (const double fraction : {0.05, 0.86}) {
        const Simulation run = after(bed(fraction, 40.0), 0.1);
        CAPTURE(fraction);
        CHECK_FALSE(run.failure());
        CHECK(between_plates(run));
    }
    GranularProblem dense; // 0.88 needs a lattice that fits the box well
    dense.beads = 1704;
    const Simulation run = after(dense, 0.02);
    CHECK_FALSE(run.failure());
    CHECK(between_plates(run));
}

TEST_CASE("a dense random start, jammed at first, settles before t = 0 and stops a run only after it") {
    GranularProblem problem = bed(0.80, 78.0);
    problem.start = Start::random;
    const State start = make_start(problem, 0);
    problem.equilibration_steps = 5000; // half a second
    Simulation settling(problem, start);
    settling.advance(5200);
    INFO((settling.failure() ? settling.failure()->message : ""));
    CHECK_FALSE(settling.failure());
    CHECK(settling.tallies().max_overlap > problem.overlap_limit);
    problem.equilibration_steps = 0;
    Simulation measured(problem, start);
    measured.advance(300);
    CHECK(measured.failure());
}

TEST_CASE("a time step that spoils the temperatures stops the run and is named") {
    // measured at phi_b = 0.80, Gamma = 7: T_xy and T_z off by 3 and 2 % at 2e-4 s, 6 and 4 % at 4e-4 s, 2
    // and 20 % at 5e-4 s
    for (const double fraction : {0.4, 0.8}) {
        const GranularProblem problem = bed(fraction);
        CAPTURE(fraction);
        CHECK(stop_message(problem, 2e-5).empty());
        CHECK(stop_message(problem, 5e-5).empty());
        CHECK(stop_message(problem, 1e-4).empty());
        for (const double dt : {2e-4, 4e-4, 5e-4}) // twice the default, and more
            CHECK_THAT(stop_message(problem, dt),
                       Contains("bead ") && Contains("time_step") && Contains("radi") && Contains("try"));
    }
}

TEST_CASE("one bead, one rod, nothing else") {
    GranularProblem bead = bed(0.0);
    bead.beads = 1;
    CHECK_FALSE(after(bead, 0.1).failure());
    GranularProblem rod = bed(0.0);
    rod.rods.push_back(beds::long_rod(0.0, 0.0, 0.0));
    const Simulation run = after(rod, 0.1);
    CHECK_FALSE(run.failure());
    CHECK(run.temperatures().z == 0.0);
    CHECK(run.psi6(3.0 * a) == 0.0);
    CHECK_THROWS_AS(make_start(bed(0.0), 0), InputError);
}

TEST_CASE("what does not fit is refused") {
    GranularProblem rod = bed(0.1, 11.0);
    rod.rods.push_back(beds::long_rod(0.0, 0.0, 0.0));
    CHECK_THROWS_WITH(Simulation(rod, State{}), Contains("length") && Contains("box"));
    CHECK_THROWS_AS(Simulation(rod, State{}), InputError);
    GranularProblem gap = bed(0.1);
    gap.plates.gap = 1.99 * a;
    CHECK_THROWS_WITH(Simulation(gap, State{}), Contains("gap") && Contains("bead diameter"));
    CHECK_THROWS_AS(Simulation(gap, State{}), InputError);
    const GranularProblem fine = bed(0.1);
    CHECK_THROWS_WITH(Simulation(fine, State{}), Contains("0 beads"));
}

TEST_CASE("a damaged state is refused, and the particle named") {
    GranularProblem problem = bed(0.3);
    problem.beads = 40;
    problem.rods.push_back(beds::long_rod(15 * a, 15 * a, 0.1));
    const State good = make_start(problem, 0);
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
        for (auto member :
             {&Beads::x, &Beads::y, &Beads::z, &Beads::vx, &Beads::vy, &Beads::vz, &Beads::wx, &Beads::wz}) {
            State state = good;
            (state.beads.*member)[17] = bad;
            CHECK_THROWS_WITH(Simulation(problem, state), Contains("bead 17"));
            CHECK_THROWS_AS(Simulation(problem, state), InputError);
        }
    State far = good;
    far.beads.x[3] = 1e20;
    CHECK_THROWS_WITH(Simulation(problem, far), Contains("bead 3"));
    for (int k = 0; k < 4; ++k) {
        State state = good;
        (k == 0   ? state.rods[0].position.y()
         : k == 1 ? state.rods[0].velocity.z()
         : k == 2 ? state.rods[0].angular_momentum.x()
                  : state.rods[0].orientation.w()) = std::nan("");
        CHECK_THROWS_WITH(Simulation(problem, state), Contains("rod 0"));
    }
    State shrunk = good;
    shrunk.rods[0].orientation.coeffs() *= 0.5;
    CHECK_THROWS_WITH(Simulation(problem, shrunk), Contains("rod 0"));
}

TEST_CASE("a particle that runs away stops the run and is named") {
    GranularProblem problem = bed(0.3);
    State state = make_start(problem, 0);
    for (const std::size_t i : {0u, 11u, 80u})
        for (const double speed : {2e6, 1e306}) {
            State wild = state;
            wild.beads.vx[i] = speed;
            Simulation run(problem, wild);
            run.advance(3);
            REQUIRE(run.failure());
            CHECK_THAT(run.failure()->message, Contains("bead " + std::to_string(i) + " "));
            CHECK(run.step() <= 2);
        }
    GranularProblem rods = problem;
    rods.beads = 20;
    rods.rods.push_back(beds::long_rod(15 * a, 15 * a, 0.1));
    State wild = make_start(rods, 0);
    wild.rods[0].velocity.y() = 3e6;
    Simulation run(rods, wild);
    run.advance(3);
    REQUIRE(run.failure());
    CHECK_THAT(run.failure()->message, Contains("rod 0"));
}

TEST_CASE("a rod that sticks in a plate stops the run") {
    GranularProblem problem = bed(0.0);
    problem.rods.push_back(beds::long_rod(15 * a, 15 * a, 0.1));
    State state = make_start(problem, 0);
    state.rods[0].position.z() -= 0.3e-3;
    Simulation run(problem, state);
    run.advance(5);
    REQUIRE(run.failure());
    CHECK_THAT(run.failure()->message, Contains("rod") && Contains("plate"));
}
