// Beads and rods against floor and lid: closed forms, touch times, rest.

#include "beds.hpp"

#include "granular/bounces.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <optional>

using namespace rodwake::granular;

namespace {

const double g = GranularProblem{}.gravity, a = GranularProblem{}.bead_radius;

GranularProblem drop_problem(double restitution, double dt) {
    GranularProblem problem = beds::still_plates(4e-3, 78 * a);
    problem.beads = 1;
    problem.time_step = dt;
    beds::set_contacts(problem, {0.2, restitution});
    return problem;
}

/// Height above the floor of a point dropped from h: hops e^k v, each 2 e^k v/g long. None once hops are
/// shorter than `shortest`.
std::optional<double> dropped(double h, double e, double t, double shortest) {
    const double fall = std::sqrt(2.0 * h / g);
    if (t <= fall)
        return h - g * t * t / 2.0;
    double v = e * g * fall;
    for (t -= fall; t > 2.0 * v / g; v *= e) {
        t -= 2.0 * v / g;
        if (2.0 * v / g < shortest)
            return {};
    }
    return 2.0 * v / g < shortest ? std::nullopt : std::optional(v * t - g * t * t / 2.0);
}

/// Largest distance from the closed form, in units of the drop.
double worst_drop_error(double e, double dt, int steps, int& compared) {
    const double h = 1e-3;
    Simulation run(drop_problem(e, dt), beds::one_bead(a + h, 0.0));
    double worst = 0.0;
    for (int n = 1; n <= steps; ++n) {
        run.advance(1);
        const auto wanted = dropped(h, e, n * dt, 0.25 * dt);
        if (!wanted)
            break;
        worst = std::max(worst, std::abs(run.state().beads.z[0] - a - *wanted) / h);
        ++compared;
    }
    REQUIRE_FALSE(run.failure());
    return worst;
}

} // namespace

TEST_CASE("a dropped bead falls, bounces at the touch and hops in a geometric series") {
    for (const double e : {1.0, 0.9, 0.5})
        for (const double dt : {2e-5, 1.3e-4, 7e-4}) {
            CAPTURE(e, dt);
            int compared = 0;
            // Up to 6000 steps: each rounds g dt into v, which adds up over time (8e-12 after 0.4 s of 2e-5 s
            // steps). A bounce at the end of the step would be off by v dt/h = 3e-3.
            CHECK(worst_drop_error(e, dt, static_cast<int>(0.12 / dt), compared) < 1e-12);
            CHECK(compared > 0.04 / dt);
        }
}

TEST_CASE("the closed form of a drop notices a bounce that is a little off") {
    const auto exact = dropped(1e-3, 0.9, 0.05, 1e-6), other = dropped(1e-3, 0.9 + 1e-9, 0.05, 1e-6);
    REQUIRE(exact);
    REQUIRE(other);
    CHECK(std::abs(*exact - *other) > 1e-12 * 1e-3);
    CHECK_FALSE(dropped(1e-3, 0.5, 0.2, 1e-6)); // hops have ended
}

TEST_CASE("a bead comes to rest on a static floor when its hops end, and does not sink") {
    const double h = 1e-3, e = 0.5, dt = 2e-5;
    Simulation run(drop_problem(e, dt), beds::one_bead(a + h, 0.0));
    const double last = std::sqrt(2.0 * h / g) * (1.0 + e) / (1.0 - e); // sum of the series
    run.advance(static_cast<std::int64_t>(last / dt) + 1);
    CHECK(run.state().beads.z[0] == Approx(a).epsilon(1e-12));
    for (int k = 0; k < 10; ++k) {
        run.advance(10000);
        CHECK(run.state().beads.z[0] == a);                   // put there each step
        CHECK(std::abs(run.state().beads.vz[0]) < 1e-15 * g); // rounding of g dt - g dt
    }
    // the floor carries the weight: all the momentum of the fall and the rest
    const double mass = 4.0 / 3.0 * M_PI * a * a * a * 2700.0;
    CHECK(run.tallies().floor_impulse ==
          Approx(mass * g * static_cast<double>(run.step()) * dt).epsilon(1e-9));
    CHECK(run.tallies().lid_impulse == 0.0);
}

namespace {

/// One step of a bead between vibrating plates: the first touch by bisection in long double, the bounce
/// there, flight to the end. Nothing if it touches no plate.
struct Bounce {
    double z, vz, touching_speed;
};

std::optional<Bounce> oracle_bounce(const GranularProblem& p, double t0, double z0, double v0) {
    using Real = long double;
    const Real A = p.plates.amplitude(p.gravity), w = 2.0L * M_PIl * p.plates.frequency, G = p.gravity,
               dt = p.time_step;
    const Real e = p.contacts.bead_plate.restitution;
    for (const Real side : {1.0L, -1.0L}) {
        const Real offset = side > 0 ? Real(a) : Real(p.plates.gap) - Real(a);
        const auto gap = [&](Real s) {
            return side * (z0 + v0 * s - G * s * s / 2 - A * std::cos(w * (t0 + s)) - offset);
        };
        if (gap(dt) >= 0)
            continue;
        Real clear = 0, inside = dt;
        for (int k = 0; k < 80; ++k)
            (gap((clear + inside) / 2) > 0 ? clear : inside) = (clear + inside) / 2;
        const Real s = inside, plate = -A * w * std::sin(w * (t0 + s)), v = v0 - G * s, left = dt - s;
        const Real after = plate - e * (v - plate), z = A * std::cos(w * (t0 + s)) + offset;
        return Bounce{static_cast<double>(z + after * left - G * left * left / 2),
                      static_cast<double>(after - G * left), static_cast<double>(side * (plate - v))};
    }
    return {};
}

} // namespace

TEST_CASE("a bead on vibrating plates bounces when it touches them") {
    for (const double dt : {2e-5, 5e-5}) {
        GranularProblem problem = beds::still_plates(1.2e-3, 78 * a);
        problem.beads = 1;
        problem.time_step = dt;
        problem.plates.gamma = 7.0;
        problem.contacts.bead_plate = {0.2, 0.8};
        const double A = problem.plates.amplitude(g), w = 2.0 * M_PI * 200.0;
        Simulation run(problem, beds::one_bead(A + a + 1e-4, 0.05));
        int bounces = 0;
        double worst_z = 0.0, worst_v = 0.0;
        for (int n = 0; n < 20000; ++n) {
            const State before = run.state();
            run.advance(1);
            const auto wanted = oracle_bounce(problem, n * dt, before.beads.z[0], before.beads.vz[0]);
            // slower ones may bounce twice in the step
            if (!wanted || wanted->touching_speed < 2.0 * 8.0 * g * dt)
                continue;
            ++bounces;
            worst_z = std::max(worst_z, std::abs(run.state().beads.z[0] - wanted->z) / A);
            worst_v = std::max(worst_v, std::abs(run.state().beads.vz[0] - wanted->vz) / (A * w));
        }
        CAPTURE(dt, bounces);
        CHECK_FALSE(run.failure());
        CHECK(bounces > 100);
        // rest of the plate's Taylor series, (w dt)^7/7! = 8e-13 of the velocity at 5e-5 s, and rounding; z
        // is about 10 A
        CHECK(worst_z < 1e-12);
        CHECK(worst_v < 2e-12); // (1 + e) times that rest
    }
}

TEST_CASE("a bead between plates hardly wider than itself bounces from both within one step") {
    GranularProblem problem = drop_problem(1.0, 2e-5);
    beds::set_contacts(problem, {0.0, 1.0});
    const double room = 2e-6, v = 0.35; // 3.5 crossings a step
    problem.plates.gap = 2.0 * a + room;
    Simulation run(problem, beds::one_bead(a + 0.3 * room, v));
    for (int n = 1; n <= 2000; ++n) {
        run.advance(1);
        const State now = run.state();
        REQUIRE(now.beads.z[0] >= a * (1.0 - 1e-14));
        REQUIRE(now.beads.z[0] <= (a + room) * (1.0 + 1e-14));
    }
    // v^2/2 + g z is kept, rounding of 7000 bounces; gravity changes v by 1e-4 only
    const Energy energy = run.energy();
    const double mass = 4.0 / 3.0 * M_PI * a * a * a * 2700.0;
    CHECK(energy.kinetic + energy.potential ==
          Approx(mass * (v * v / 2.0 + g * (a + 0.3 * room))).epsilon(1e-12));
    CHECK(run.tallies().bead_plate == Approx(3.5 * 2000).epsilon(0.01));
}

TEST_CASE("hops shorter than a step are followed, not swallowed") {
    // speed at which a hop lasts 0.4 steps
    const double dt = 1e-3, v = 0.2 * g * dt;
    Simulation run(drop_problem(1.0, dt), beds::one_bead(a, v));
    run.advance(1); // two hops and a half: at the top
    CHECK(run.state().beads.z[0] - a == Approx(v * v / (2.0 * g)).epsilon(1e-9));
    CHECK(run.tallies().bead_plate == 2);
}

namespace {

/// One rod on a static floor, dropped without any motion of its own.
State dropped_rod(GranularProblem& problem, double heading) {
    problem = beds::still_plates(1.2e-3, 50 * a);
    problem.time_step = 1e-4;
    problem.rods.push_back(beds::long_rod(25 * a, 25 * a, heading));
    State start = make_start(problem, 0);
    start.rods[0].velocity.setZero();
    start.rods[0].angular_momentum.setZero();
    return start;
}

double energy_of(const Simulation& run) { return run.energy().kinetic + run.energy().potential; }

} // namespace

TEST_CASE("a rod on a static floor comes to rest and the floor carries its weight") {
    GranularProblem problem;
    Simulation run(problem, dropped_rod(problem, 0.3));
    run.advance(2000); // falls and settles
    const RodBody before = run.rod(0);
    const double carried = run.tallies().floor_impulse;
    run.advance(3000);
    CHECK(run.rod(0).position == before.position); // to the bit
    CHECK(run.rod(0).orientation.coeffs() == before.orientation.coeffs());
    CHECK(run.tallies().floor_impulse - carried ==
          Approx(make_clump(problem.rods[0].shape).mass * g * 0.3).epsilon(1e-12));
    CHECK_FALSE(run.failure());
}

TEST_CASE("a rod that slides along itself on a static floor stops where friction has taken its energy") {
    GranularProblem problem;
    Simulation settling(problem, dropped_rod(problem, 0.0));
    settling.advance(2000);
    State thrown = settling.state();
    const double speed = 0.05, mu = problem.contacts.rod_plate.friction;
    thrown.rods[0].velocity.x() = speed;
    Simulation run(problem, thrown);
    double energy = energy_of(run);
    for (int k = 0; k < 2500; ++k) {
        run.advance(1);
        CHECK(energy_of(run) <= energy * (1.0 + 1e-12));
        energy = energy_of(run);
    }
    const double way = run.rod(0).position.x() - thrown.rods[0].position.x();
    // impulses at two ends one after the other, and the last g dt of its speed: 0.02 % measured
    CHECK(way == Approx(speed * speed / (2.0 * mu * g)).epsilon(1e-3));
    CHECK(run.rod(0).velocity.norm() == 0.0);
    CHECK_FALSE(run.failure());
}
