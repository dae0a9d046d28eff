// Beads and rods in a container: closed forms, conservation, that nothing gets out, and bits.

#include "beds.hpp"
#include "granular/wall.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;
using Catch::Contains;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double a = 0.4e-3, gap = 1.2e-3;
constexpr double frictionless = 0.0;

GranularProblem in_container(const Container& container) {
    GranularProblem problem = beds::still_plates(gap, container.box());
    problem.gravity = 0.0;
    problem.container = container;
    problem.start_speed = 0.0;
    problem.beads = 1;
    return problem;
}

GranularProblem in_dish(double radius, const Surface& wall = {frictionless, 1.0}) {
    return in_container({ContainerKind::circle, 2.0 * radius, wall, wall});
}

GranularProblem in_rectangle(double x, double y, const Surface& wall = {frictionless, 1.0}) {
    return in_container({ContainerKind::rectangle, {x, y}, wall, wall});
}

/// One bead there, at mid gap.
State bead_at(const GranularProblem& problem, const Vector2d& from_middle, const Vector3d& velocity,
              const Vector3d& spin = Vector3d::Zero()) {
    State state = beds::one_bead(0.5 * problem.plates.gap, velocity.z());
    Beads& b = state.beads;
    b.x[0] = 0.5 * problem.container->sides.x + from_middle.x();
    b.y[0] = 0.5 * problem.container->sides.y + from_middle.y();
    b.vx[0] = velocity.x();
    b.vy[0] = velocity.y();
    b.wx[0] = spin.x();
    b.wy[0] = spin.y();
    b.wz[0] = spin.z();
    return state;
}

Vector2d from_middle(const Simulation& s) {
    const State state = s.state();
    const Container& c = *s.problem().container;
    return {state.beads.x[0] - 0.5 * c.sides.x, state.beads.y[0] - 0.5 * c.sides.y};
}

Vector3d velocity_of_bead(const State& state) {
    return {state.beads.vx[0], state.beads.vy[0], state.beads.vz[0]};
}
Vector3d spin_of_bead(const State& state) {
    return {state.beads.wx[0], state.beads.wy[0], state.beads.wz[0]};
}

/// How far the bead that is furthest out is through the wall.
double deepest_bead(const State& state, const GranularProblem& problem) {
    double deepest = -1.0;
    for (std::size_t i = 0; i < state.beads.size(); ++i)
        deepest = std::max(deepest, nearest_wall(*problem.container, {state.beads.x[i], state.beads.y[i]},
                                                 problem.bead_radius)
                                        .depth);
    return deepest;
}

/// Many beads, plates that shake them.
GranularProblem shaken(Container container, double phi, Start start = Start::lattice) {
    container.beads = {0.2, 0.3};
    GranularProblem problem = in_container(container);
    problem.gravity = 9.81;
    problem.plates.gamma = 7.0;
    problem.time_step = 1e-4;
    problem.overlap_limit = 0.3;
    problem.start = start;
    problem.start_speed = 0.02;
    problem.beads = static_cast<std::size_t>(std::lround(phi * container.area() / (M_PI * a * a)));
    return problem;
}

} // namespace

TEST_CASE("a bead in a smooth dish flies along chords of one length, at one angle, for ever") {
    const double radius = 6.0 * a, reach = radius - a;
    const auto [speed, angle] = GENERATE(std::pair{0.05, 0.3}, std::pair{2.0, 1.2}, std::pair{2e2, 0.02});
    const GranularProblem problem = in_dish(radius);
    // from the wall, at `angle` from its normal: a chord 2 R' cos(angle) long, which turns by pi - 2 angle
    Simulation s(problem,
                 bead_at(problem, {reach, 0.0}, speed * Vector3d(-std::cos(angle), std::sin(angle), 0.0)));
    const double chord = 2.0 * reach * std::cos(angle), flight = chord / speed;
    const auto steps = static_cast<std::int64_t>(40.5 * flight / problem.time_step) + 1;
    s.advance(steps);
    REQUIRE_FALSE(s.failure());
    const double time = static_cast<double>(steps) * problem.time_step, chords = std::floor(time / flight),
                 turn = chords * (M_PI - 2.0 * angle), done = (time - chords * flight) * speed;
    const Eigen::Rotation2Dd turned(turn);
    const Vector2d along = turned * Vector2d(-std::cos(angle), std::sin(angle));
    const Vector2d expected = turned * Vector2d(reach, 0.0) + done * along;
    const double rounding = 1e-10; // 41 chords and up to some 1e5 steps, errors of angle grow with the chords
    CHECK((from_middle(s) - expected).norm() < rounding * radius);
    CHECK((velocity_of_bead(s.state()).head<2>() - speed * along).norm() < rounding * speed);
    CHECK(s.tallies().bead_wall == static_cast<std::int64_t>(chords));
}

TEST_CASE("a bead in a smooth rectangle flies as its image does straight on, corners and all") {
    const double x = 10.0 * a, y = 7.0 * a, speed = GENERATE(0.3, 1e2, 3e2); // up to 3 bounces a step
    const GranularProblem problem = in_rectangle(x, y);
    const Vector2d start(0.3 * a, -0.2 * a), v = speed * Vector2d(0.8, 0.6);
    Simulation s(problem, bead_at(problem, start, {v.x(), v.y(), 0.0}));
    const int steps = 1000;
    s.advance(steps);
    const Vector2d image = start + steps * problem.time_step * v;
    const auto folded = [](double place, double side) { // into [-side/2, side/2], to and fro
        const double phase = place / (2.0 * side) + 0.25, turn = phase - std::floor(phase);
        return side * (turn < 0.5 ? 2.0 * turn - 0.5 : 1.5 - 2.0 * turn);
    };
    const Vector2d expected(folded(image.x(), x - 2.0 * a), folded(image.y(), y - 2.0 * a));
    const double rounding = 1e-14 * image.norm();
    CHECK((from_middle(s) - expected).norm() < 10.0 * rounding);
}

TEST_CASE("one impact of a bead on the wall follows the closed form, spin included") {
    // a solid sphere on a plane: K_t = 7/2 K_n; sticks if the friction suffices, else slips all the way
    const auto [friction, restitution] = GENERATE(std::pair{0.5, 0.6}, std::pair{0.02, 0.3});
    const Vector2d outwards(std::cos(0.4), std::sin(0.4)), across(-outwards.y(), outwards.x());
    const Vector2d in_plane = 0.3 * outwards + 0.1 * across;
    const Vector3d v(in_plane.x(), in_plane.y(), 0.05), w(20.0, -30.0, 50.0);
    const bool round = GENERATE(true, false);
    GranularProblem problem = round ? in_dish(10.0 * a, {friction, restitution})
                                    : in_rectangle(20.0 * a, 20.0 * a, {friction, restitution});
    problem.contacts.bead_plate = {0.0, 1.0};
    const Vector2d normal = round ? outwards : Vector2d::UnitX();
    const Vector2d start =
        round ? Vector2d(8.99 * a * outwards - 1e-3 * a * across) : Vector2d(8.99 * a, 0.0);
    Simulation s(problem, bead_at(problem, start, v, w));
    s.advance(1);
    REQUIRE(s.tallies().bead_wall == 1);
    // where it touches
    Vector2d n = normal;
    if (round) {
        const double along = start.dot(in_plane), speed2 = in_plane.squaredNorm(),
                     gap2 = 81.0 * a * a - start.squaredNorm();
        const double time = (-along + std::sqrt(along * along + speed2 * gap2)) / speed2;
        n = (start + time * in_plane) / (9.0 * a);
    }
    const Vector3d inwards(-n.x(), -n.y(), 0.0), arm = -a * inwards;
    const double mass = bead_mass(problem), inertia = 0.4 * mass * a * a, approach = v.dot(inwards);
    const Vector3d slip = v + w.cross(arm) - approach * inwards;
    const double push = -(1.0 + restitution) * mass * approach,
                 stick = slip.norm() * mass / 3.5; // stops the slip
    const Vector3d impulse = push * inwards - std::min(friction * push, stick) * slip.normalized();
    CHECK((stick < friction * push) == (friction == 0.5));
    const double rounding = 1e-13;
    CHECK((velocity_of_bead(s.state()) - (v + impulse / mass)).norm() < rounding * v.norm());
    CHECK((spin_of_bead(s.state()) - (w + arm.cross(impulse) / inertia)).norm() < 10.0 * rounding * w.norm());
    CHECK(s.tallies().wall_impulse == Approx(push).epsilon(rounding));
}

TEST_CASE("a rod that hits a smooth elastic wall with one end turns as the closed form says") {
    GranularProblem problem = in_rectangle(40.0 * a, 40.0 * a);
    problem.beads = 0;
    const double heading = 0.7, speed = 0.2;
    problem.rods = {beds::long_rod(30.0 * a, 20.0 * a, heading)};
    State state = make_start(problem, 0);
    state.rods[0].velocity = {speed, 0.01, 0.0};
    state.rods[0].angular_momentum.setZero();
    Simulation s(problem, state);
    const Clump clump = make_clump(problem.rods[0].shape);
    const double energy = s.energy().kinetic;
    for (int k = 0; k < 20000 && s.tallies().rod_wall == 0; ++k)
        s.advance(1);
    REQUIRE(s.tallies().rod_wall == 1);
    // the thin end's sphere touches: v_n = v_x; arm about z: -offset sin(heading) from the normal x
    const double arm = clump.offset.back() * std::sin(heading),
                 k = 1.0 / clump.mass + arm * arm / clump.transverse_inertia, push = 2.0 * speed / k;
    const RodBody& rod = s.rod(0);
    const double rounding = 1e-12;
    CHECK(rod.velocity.x() == Approx(speed - push / clump.mass).epsilon(rounding));
    CHECK(rod.velocity.y() == Approx(0.01).epsilon(rounding));
    CHECK(rod.angular_momentum.z() == Approx(push * arm).epsilon(1e-9)); // the heading is that of the start
    CHECK(s.tallies().wall_impulse == Approx(push).epsilon(rounding));
    CHECK(s.energy().kinetic == Approx(energy).epsilon(rounding));
}

TEST_CASE("a rod in a round dish: its ends touch the curved wall, energy stays, and it stays inside") {
    GranularProblem problem = in_dish(9.0 * a);
    problem.beads = 0;
    problem.contacts.rod_plate = {0.0, 1.0};
    problem.gravity = 9.81;
    problem.rods = {beds::long_rod(9.0 * a, 9.0 * a, 0.3)};
    State state = make_start(problem, 0);
    state.rods[0].velocity = {0.05, 0.02, 0.01};
    Simulation s(problem, state);
    const Clump clump = make_clump(problem.rods[0].shape);
    const Energy before = s.energy();
    double deepest = -1.0;
    for (int k = 0; k < 3000; ++k) {
        s.advance(20);
        for (std::size_t i = 0; i < clump.radius.size(); ++i) {
            const Vector3d centre = s.rod(0).position + clump.offset[i] * s.rod(0).axis();
            deepest =
                std::max(deepest, nearest_wall(*problem.container, centre.head<2>(), clump.radius[i]).depth);
        }
    }
    REQUIRE_FALSE(s.failure());
    CHECK(s.tallies().rod_wall > 20);
    const double in_a_step = 0.3 * problem.time_step; // ends are slower than 0.3 m/s
    CHECK(deepest < in_a_step);
    CHECK(deepest > -0.05 * a); // it does get there
    CHECK(s.energy().kinetic + s.energy().potential ==
          Approx(before.kinetic + before.potential).epsilon(1e-9));
}

TEST_CASE("a bead slides along the curved wall when its hops get short, and off a straight one") {
    GranularProblem problem = in_dish(6.0 * a, {0.0, 0.5});
    Simulation s(problem, bead_at(problem, {4.0 * a, 0.0}, {0.05, 0.2, 0.0}));
    s.advance(20000);
    const double distance = from_middle(s).norm();
    CHECK(distance == Approx(5.0 * a).epsilon(1e-9)); // on the wall, and not through it
    // what is across the wall at the first touch is lost, the rest stays
    CHECK(velocity_of_bead(s.state()).norm() < std::hypot(0.05, 0.2));
    CHECK(velocity_of_bead(s.state()).norm() > 0.1);
}

TEST_CASE("a bead that was pushed deep into the wall comes out as it slides, once the bed has settled") {
    GranularProblem problem = in_dish(20 * a, {frictionless, 0.0});
    for (const bool settles : {true, false}) {
        problem.equilibration_steps = settles ? 500 : 0;
        Simulation run(problem, bead_at(problem, {19.08 * a, 0.0}, {0.0, 0.02, 0.0}));
        run.advance(400);
        CAPTURE(settles);
        // to what one step along the curved wall changes, (v dt)^2/(2 R) = 1e-11 m = 3e-8 a, and one move
        CHECK((from_middle(run).norm() - 19 * a) / a == Approx(settles ? 0.08 : 0.05).margin(1e-4));
    }
}

TEST_CASE("elastic beads and rods keep their energy, and nobody gets out") {
    const bool round = GENERATE(true, false);
    GranularProblem problem = round ? in_dish(15.0 * a) : in_rectangle(30.0 * a, 26.0 * a);
    beds::set_contacts(problem, {frictionless, 1.0});
    problem.beads = 60;
    problem.gravity = 9.81;
    problem.start_speed = 0.1;
    problem.rods = {beds::long_rod(10.0 * a, 13.0 * a, 1.0), beds::long_rod(22.0 * a, 13.0 * a, 0.2)};
    State state = make_start(problem, 0);
    state.rods[1].velocity.x() = 0.2;
    Simulation s(problem, state);
    const double before = s.energy().kinetic + s.energy().potential;
    double deepest = 0.0;
    for (int k = 0; k < 100; ++k) {
        s.advance(100);
        deepest = std::max(deepest, deepest_bead(s.state(), problem));
    }
    REQUIRE_FALSE(s.failure());
    CHECK(s.tallies().bead_wall > 200);
    CHECK(s.tallies().rod_wall > 0);
    CHECK(s.energy().kinetic + s.energy().potential == Approx(before).epsilon(1e-8));
    CHECK(deepest < 1.0 * problem.time_step); // beads are slower than 1 m/s
}

TEST_CASE("starts in a container: the beads asked for, inside, apart") {
    const bool round = GENERATE(true, false);
    const Start start = GENERATE(Start::lattice, Start::random);
    GranularProblem problem = shaken(
        {round ? ContainerKind::circle : ContainerKind::rectangle, {40.0 * a, round ? 40.0 * a : 30.0 * a}},
        start == Start::lattice ? 0.78 : 0.70, start);
    problem.rods = {beds::long_rod(15.0 * a, 15.0 * a, 0.5)};
    problem.beads -= 8;
    const State state = make_start(problem, 0);
    CHECK(state.beads.size() == problem.beads);
    CHECK(deepest_bead(state, problem) <= 0.0);
    CHECK(beds::all_overlaps(make_bodies(problem, state), problem.box).empty());
    CHECK(bead_area_fraction(problem) ==
          Approx(static_cast<double>(problem.beads) * M_PI * a * a / problem.container->area()));
    const State again = restart_from(problem, state, 1);
    CHECK(deepest_bead(again, problem) <= 0.0);
}

TEST_CASE("a dense bed in a dish: the same bits for any number of threads, and gone on from a state",
          "[threads]") {
    GranularProblem problem = shaken({ContainerKind::circle, 120.0 * a}, 0.72);
    problem.container->rods = {0.03, 0.1};
    problem.rods = {beds::long_rod(8.0 * a, 60.0 * a, M_PI), beds::long_rod(60.0 * a, 60.0 * a, 0.0)};
    problem.beads -= 20;
    REQUIRE(problem.beads > beads_per_block);
    State start = make_start(problem, 0);
    start.rods[0].velocity.x() = -0.3;
    std::vector<std::uint64_t> hashes;
    for (const std::size_t threads : {1, 2, 3}) {
        Simulation s(problem, start, {}, threads);
        s.advance(400);
        REQUIRE_FALSE(s.failure());
        CHECK(s.tallies().bead_wall > 100);
        CHECK(s.tallies().rod_wall > 0);
        hashes.push_back(state_hash(s.state()));
    }
    CHECK(hashes[1] == hashes[0]);
    CHECK(hashes[2] == hashes[0]);
    Simulation first(problem, start);
    first.advance(137);
    Simulation second(problem, first.state(), first.tallies());
    second.advance(263);
    CHECK(state_hash(second.state()) == hashes[0]);
    CHECK(deepest_bead(second.state(), problem) < 0.1 * a);
}

TEST_CASE("order in a container is that of beads with all their neighbours") {
    GranularProblem problem = shaken({ContainerKind::circle, 40.0 * a}, 0.6);
    problem.start_speed = 0.0;
    const double cutoff = neighbour_cutoff(a, 0.6);
    const Simulation s(problem, make_start(problem, 0));
    CHECK(s.psi6(cutoff) > 0.8); // some sites of the lattice are left out
    CHECK(s.psi6(25.0 * a) == 0.0);
}

TEST_CASE("containers that cannot be are refused, with what to do") {
    GranularProblem problem = in_dish(20.0 * a);
    problem.beads = 10;
    CHECK_NOTHROW(validate(problem));
    SECTION("rod through the wall") {
        problem.rods = {beds::long_rod(37.0 * a, 20.0 * a, 0.0)};
        CHECK_THROWS_WITH(validate(problem), Contains("rod 0: move or turn it") && Contains("wall"));
    }
    SECTION("rod driven through the wall") {
        problem.rods = {beds::long_rod(20.0 * a, 20.0 * a, 0.0)};
        problem.rods[0].imposed_speed = 1e-3;
        problem.steps = 100;
        CHECK_NOTHROW(validate(problem));
        problem.steps = 1'000'000;
        CHECK_THROWS_WITH(validate(problem), Contains("shorten the duration") && Contains("imposed_speed"));
    }
    SECTION("a box of its own") {
        problem.box = 50.0 * a;
        CHECK_THROWS_WITH(validate(problem), Contains("twice the sides"));
    }
    SECTION("too small") {
        problem.container->sides = 3.0 * a;
        problem.box = problem.container->box();
        CHECK_THROWS_WITH(validate(problem), Contains("at least 4 bead radii"));
    }
    SECTION("too many beads") {
        problem.beads = 380;
        CHECK_THROWS_WITH(validate(problem), Contains("larger container"));
    }
    SECTION("a force that moves through a periodic box") {
        problem.body_force = BodyForce{.kind = BodyForceKind::gaussian, .acceleration = 1.0, .width = a};
        CHECK_THROWS_WITH(validate(problem), Contains("gaussian"));
    }
    SECTION("a state of another container") {
        const State outside = bead_at(problem, {25.0 * a, 0.0}, Vector3d::Zero());
        problem.beads = 1;
        CHECK(deepest_bead(outside, problem) == Approx(6.0 * a));
        CHECK_THROWS_WITH(Simulation(problem, outside), Contains("outside the wall"));
    }
}

TEST_CASE("no bead is lost in a thousand million bounces off the wall", "[.][long]") {
    // single beads, from slow ones to those that cross the dish several times a step, with and without losses
    std::int64_t bounces = 0;
    const std::int64_t wanted = 1'000'000'000;
    double deepest = -1.0, worst_energy = 0.0;
    for (std::uint32_t round = 0; bounces < wanted; ++round) {
        RandomStream random(7, round, 0);
        const bool disc = round % 2 == 0, lossless = round % 4 < 2;
        const double side = a * random.uniform(4.0, 12.0),
                     other = disc ? side : a * random.uniform(4.0, 12.0);
        const Surface surface{lossless ? 0.0 : random.uniform(0.0, 0.5), lossless ? 1.0 : 0.999};
        GranularProblem problem = in_container(
            {disc ? ContainerKind::circle : ContainerKind::rectangle, {side, other}, surface, surface});
        problem.contacts.bead_plate = {0.0, 1.0};
        const double angle = random.uniform(0.0, 2.0 * M_PI),
                     speed = 0.3 * a / problem.time_step * std::pow(10.0, random.uniform(0.0, 1.5));
        Simulation s(problem, bead_at(problem, {0.1 * a, 0.2 * a},
                                      speed * Vector3d(std::cos(angle), std::sin(angle), 1e-6)));
        const double before = s.energy().kinetic;
        for (int part = 0; part < 20; ++part) {
            s.advance(10'000);
            INFO("round " << round << ": " << (s.failure() ? s.failure()->message : ""));
            REQUIRE_FALSE(s.failure());
            deepest = std::max(deepest, deepest_bead(s.state(), problem) / a);
        }
        if (lossless)
            worst_energy = std::max(worst_energy, std::abs(s.energy().kinetic / before - 1.0));
        bounces += s.tallies().bead_wall;
        if (round % 50 == 49)
            std::fprintf(stderr, "%u dishes, %lld bounces\n", round + 1, static_cast<long long>(bounces));
    }
    std::printf("%lld bounces, deepest %.2g a, energy kept to %.2g\n", static_cast<long long>(bounces),
                deepest, worst_energy);
    CHECK(deepest < 1e-9);
    CHECK(worst_energy < 1e-9); // 1e6 bounces each round by a few roundings
}
