// Whole runs: bits that depend on nothing but the problem; energy.

#include "beds.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

const double a = GranularProblem{}.bead_radius;

GranularProblem shaken(double side, std::size_t beads) {
    GranularProblem problem;
    problem.box = side * a;
    problem.beads = beads;
    return problem;
}

std::uint64_t hash_with(const GranularProblem& problem, const State& start, std::size_t threads,
                        std::int64_t steps) {
    Simulation run(problem, start, {}, threads);
    run.advance(steps);
    CHECK_FALSE(run.failure());
    return state_hash(run.state());
}

bool same(const Counters& x, const Counters& y) {
    return x.floor_impulse == y.floor_impulse && x.lid_impulse == y.lid_impulse &&
           x.bead_bead == y.bead_bead && x.bead_plate == y.bead_plate && x.bead_rod == y.bead_rod &&
           x.rod_plate == y.rod_plate && x.rod_rod == y.rod_rod && x.overlaps == y.overlaps &&
           x.max_overlap == y.max_overlap && x.impulse_on_beads == y.impulse_on_beads &&
           x.impulse_from_plates == y.impulse_from_plates && x.virial == y.virial;
}

double total(const Simulation& run) { return run.energy().kinetic + run.energy().potential; }

/// Largest change of the energy of an elastic bed, of itself.
double energy_change(std::int64_t steps, double speed, double gravity) {
    GranularProblem problem = beds::still_plates(1.2e-3, 50 * a);
    problem.gravity = gravity;
    problem.beads = 500;
    problem.rods.push_back(beds::long_rod(25 * a, 25 * a, 0.3));
    problem.start_speed = speed;
    beds::set_contacts(problem, {0.0, 1.0});
    Simulation run(problem, make_start(problem, 0));
    const double before = total(run);
    double worst = 0.0;
    for (int k = 0; k < 20; ++k) {
        run.advance(steps / 20);
        worst = std::max(worst, std::abs(total(run) / before - 1.0));
    }
    CHECK_FALSE(run.failure());
    CHECK(run.tallies().bead_rod > 0);
    CHECK(run.tallies().rod_plate > 0);
    CHECK(run.tallies().bead_bead > steps / 100);
    return worst;
}

} // namespace

TEST_CASE("an elastic bed between static plates keeps its energy") {
    for (const double gravity : {9.81, 0.0})
        for (const double speed : {0.02, 0.1}) // measured 1e-12 after 1e5 steps: rounding of 1e5 additions
            CHECK(energy_change(2000, speed, gravity) < 1e-11);
}

TEST_CASE("an elastic bed keeps its energy to 1e-9 over 1e5 steps", "[.][long]") {
    for (const double gravity : {9.81, 0.0})
        for (const double speed : {0.02, 0.1})
            CHECK(energy_change(100000, speed, gravity) < 1e-9);
}

TEST_CASE("with losses an unshaken bed only loses energy") {
    GranularProblem problem = beds::still_plates(1.2e-3, 30 * a);
    problem.beads = 200;
    problem.start_speed = 0.1;
    Simulation run(problem, make_start(problem, 0));
    for (double before = total(run); run.step() < 3000; before = total(run)) {
        run.advance(10);
        REQUIRE(total(run) <= before * (1.0 + 1e-14));
    }
}

TEST_CASE("without gravity a bed starts at its temperature, shares it among all directions and never rests") {
    GranularProblem problem = beds::still_plates(1.2e-3, 60 * a);
    problem.gravity = 0.0;
    problem.beads = 800;
    problem.start_speed = 0.05;
    beds::set_contacts(problem, {0.0, 1.0});
    Simulation run(problem, make_start(problem, 0));
    const double asked = 0.05 * 0.05, scatter = 4.0 * std::sqrt(2.0 / 800.0); // four errors of a variance
    CHECK(run.temperatures().z == Approx(asked).epsilon(scatter));
    CHECK(run.temperatures().xy == Approx(asked).epsilon(scatter));
    double ratio = 0.0;
    run.advance(5000);
    for (int k = 0; k < 200; ++k) {
        run.advance(100);
        ratio += run.temperatures().z / run.temperatures().xy / 200.0;
    }
    // one instant scatters by 6 %, some 20 are independent; steps of 2e-5 s make it 1 to 2 % too small, of
    // 1e-4 s 6 %
    CHECK(ratio == Approx(1.0).epsilon(0.05));
    CHECK(run.energy().potential == 0.0);
}

TEST_CASE("without gravity bodies that lose everything at the plates stop bouncing, and nothing hangs") {
    for (const double restitution : {0.0, 0.3}) {
        GranularProblem problem = beds::still_plates(1.2e-3, 30 * a);
        problem.gravity = 0.0;
        problem.beads = 150;
        problem.start_speed = 0.1;
        problem.rods.push_back(beds::long_rod(15 * a, 15 * a, 0.3));
        beds::set_contacts(problem, {0.1, restitution});
        Simulation run(problem, make_start(problem, 0));
        const double first = total(run);
        for (double before = first; run.step() < 5000; before = total(run)) {
            run.advance(50);
            REQUIRE(total(run) <= before * (1.0 + 1e-13));
        }
        CHECK_FALSE(run.failure());
        CHECK(total(run) > 0.0);
        CHECK(total(run) < 0.2 * first);
    }
}

TEST_CASE("timing the parts of steps does not change a bit") {
    GranularProblem problem = shaken(30, 215);
    problem.rods.push_back(beds::long_rod(10 * a, 10 * a, 0.3));
    const State start = make_start(problem, 0);
    Simulation timed(problem, start);
    StepTimes times = timed.advance_timed(200);
    times += timed.advance_timed(100);
    CHECK(state_hash(timed.state()) == hash_with(problem, start, 1, 300));
    CHECK(times.steps == 300);
    for (const double part : {times.flight, times.rods, times.search, times.impulses})
        CHECK(part > 0.0);
}

TEST_CASE("threads do not change a bit") {
    GranularProblem problem = shaken(240, 1700); // six chunks of beads
    problem.rods.push_back(beds::long_rod(100 * a, 100 * a, 0.3));
    const State start = make_start(problem, 0);
    const std::uint64_t one = hash_with(problem, start, 1, 700);
    CHECK(hash_with(problem, start, 2, 700) == one);
    CHECK(hash_with(problem, start, 3, 700) == one);
    CHECK(hash_with(problem, start, 1, 699) != one);
}

TEST_CASE("threads do not change a bit of a short run", "[threads]") { // small enough for ThreadSanitizer
    GranularProblem problem = shaken(220, 10000);
    const State start = make_start(problem, 0);
    const std::uint64_t one = hash_with(problem, start, 1, 60);
    Simulation apart(problem, start); // timed: all blocks fly, then all pairs are tested
    apart.advance_timed(60);
    CHECK(state_hash(apart.state()) == one);
    CHECK(hash_with(problem, start, 2, 60) == one);
    CHECK(hash_with(problem, start, 3, 60) == one);
}

TEST_CASE("small beds get one thread, large ones as many as have work", "[threads]") {
    const auto threads = [](std::size_t beads, std::size_t most) {
        GranularProblem problem;
        problem.beads = beads;
        return worthwhile_threads(problem, most);
    };
    for (const std::size_t beads : {0U, 1U, 500U, 1549U, 6110U, 24440U})
        CHECK(threads(beads, 64) == 1);
    CHECK(threads(100'000, 1) == 1);
    CHECK(threads(100'000, 2) == 2);
    CHECK(threads(100'000, 64) < 10);
}

TEST_CASE("a run that is interrupted anywhere goes on with the same bits") {
    GranularProblem problem = shaken(36, 220);
    problem.rods = {beds::long_rod(18 * a, 8 * a, 0.2), beds::long_rod(18 * a, 18 * a, 1.0),
                    beds::long_rod(18 * a, 28 * a, -0.3)};
    problem.rods[1].imposed_speed = 0.01; // held on; the first and third are let go
    problem.equilibration_steps = 700;
    problem.steps = 1500;
    const State start = make_start(problem, 0);
    Simulation whole(problem, start);
    whole.advance(2200);
    REQUIRE_FALSE(whole.failure());
    CHECK(whole.finished());
    CHECK(whole.tallies().bead_rod > 20);
    RandomStream random(41);
    for (int k = 0; k < 20; ++k) {
        const std::int64_t n = k == 0 ? 700
                               : k == 1
                                   ? 699
                                   : static_cast<std::int64_t>(random.uniform(0.0, k < 8 ? 700.0 : 2200.0));
        Simulation first(problem, start);
        first.advance(n);
        Simulation second(problem, first.state(), first.tallies());
        CHECK(second.step() == n);
        second.advance(2200 - n);
        CAPTURE(n);
        CHECK(state_hash(second.state()) == state_hash(whole.state()));
        CHECK(same(second.tallies(), whole.tallies()));
    }
}

TEST_CASE("a run restarted at every step has the bits of one that never stopped") {
    GranularProblem problem = shaken(24, 80); // lists are new at each step: none is ever too old or too short
    problem.rods.push_back(beds::long_rod(12 * a, 12 * a, 0.4));
    Simulation whole(problem, make_start(problem, 0)), restarted(problem, whole.state());
    for (int n = 0; n < 1500; ++n) {
        whole.advance(1);
        restarted.advance(1);
        restarted = Simulation(problem, restarted.state(), restarted.tallies());
    }
    CHECK(state_hash(whole.state()) == state_hash(restarted.state()));
    CHECK(same(whole.tallies(), restarted.tallies()));
}

TEST_CASE("rods are held while the bed settles and let go at t = 0") {
    GranularProblem problem = shaken(36, 220);
    problem.rods = {beds::long_rod(18 * a, 10 * a, 0.2), beds::long_rod(18 * a, 26 * a, 1.0)};
    problem.rods[1].imposed_speed = 0.01;
    problem.equilibration_steps = 1000;
    Simulation run(problem, make_start(problem, 0));
    const Eigen::Vector2d place = run.rod(0).position.head<2>(), other = run.rod(1).position.head<2>();
    run.advance(1000);
    CHECK(run.time() == 0.0);
    CHECK(run.rod(0).position.head<2>() == place);
    CHECK(run.rod(1).position.head<2>() == other);
    run.advance(1000);
    CHECK(run.rod(0).position.head<2>() != place);
    // 1000 sums of size 1e-2: rounding
    const Eigen::Vector2d moved = run.rod(1).position.head<2>() - other;
    CHECK((moved - 0.01 * 1000 * problem.time_step * Eigen::Vector2d(std::cos(1.0), std::sin(1.0))).norm() <
          1e-14);
    CHECK(run.rod(1).heading() == Approx(1.0).epsilon(1e-13));
    CHECK(run.rod(0).heading() != Approx(0.2).epsilon(1e-9));
}
