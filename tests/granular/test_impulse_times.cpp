// Impulses act at the instant of touch: rods that drop on a floor, bodies that meet in free flight.

#include "beds.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

using Real = long double;
using RealVector = Eigen::Matrix<Real, 3, 1>;

const double g = GranularProblem{}.gravity, a = GranularProblem{}.bead_radius;

GranularProblem room(std::size_t beads, double restitution, double dt) {
    GranularProblem problem = beds::still_plates(20e-3, 78 * a);
    problem.beads = beads;
    problem.time_step = dt;
    beds::set_contacts(problem, {0.0, restitution});
    return problem;
}

// --- a rod that falls on a floor
// ----------------------------------------------------------------------------

/// A rod in the plane of its axis and the vertical, without friction: height and pitch, each impact found in
/// steps of 1 us and by bisection.
struct FallingRod {
    Clump clump;
    Real z, vz, pitch, rate, restitution, slowest = 1.0L; ///< slowest: of the impacts so far, m/s

    Real gap(std::size_t k, Real time) const {
        return z + vz * time - g * time * time / 2 + clump.offset[k] * std::sin(pitch + rate * time) -
               clump.radius[k];
    }
    void fly(Real time) {
        z += vz * time - g * time * time / 2;
        vz -= g * time;
        pitch += rate * time;
    }
    Real touch(std::size_t k, Real within) const {
        Real clear = 0, inside = within;
        for (int i = 0; i < 80; ++i)
            (gap(k, (clear + inside) / 2) > 0 ? clear : inside) = (clear + inside) / 2;
        return inside;
    }
    void bounce(std::size_t k) {
        const Real lever = clump.offset[k] * std::cos(pitch), speed = -(vz + lever * rate);
        const Real impulse = (1 + restitution) * speed /
                             (1 / Real(clump.mass) + lever * lever / Real(clump.transverse_inertia));
        vz += impulse / Real(clump.mass);
        rate += lever * impulse / Real(clump.transverse_inertia);
        slowest = std::min(slowest, speed);
    }
    void advance(Real time) {
        while (time > 0) {
            Real next = std::min(time, 1e-6L);
            std::size_t touching = clump.radius.size();
            for (std::size_t k = 0; k < clump.radius.size(); ++k)
                if (gap(k, next) < 0) {
                    next = touch(k, next);
                    touching = k;
                }
            fly(next);
            time -= next;
            if (touching < clump.radius.size())
                bounce(touching);
        }
    }
};

constexpr double drop = 1e-3;

FallingRod falling(double pitch, double restitution) {
    const Clump clump = make_clump(RodSpec{}.shape);
    double lowest = 0.0;
    for (std::size_t k = 0; k < clump.radius.size(); ++k)
        lowest = std::max(lowest, clump.radius[k] - clump.offset[k] * std::sin(pitch));
    return {clump, Real(lowest) + Real(drop), 0, pitch, 0, restitution};
}

State lifted(const FallingRod& rod) {
    State state;
    state.rods.resize(1);
    state.rods[0].position.z() = static_cast<double>(rod.z);
    state.rods[0].orientation = Eigen::AngleAxisd(-static_cast<double>(rod.pitch), Eigen::Vector3d::UnitY());
    return state;
}

/// Largest distance of the centre's height from the integration, in units of the drop, until impacts become
/// slow: there the rod comes to rest.
double worst_rod_error(double pitch, double dt, double restitution_there, int& impacts) {
    GranularProblem problem = room(0, 0.5, dt);
    problem.rods = {beds::long_rod(0.0, 0.0, 0.0)};
    FallingRod wanted = falling(pitch, restitution_there);
    Simulation run(problem, lifted(wanted));
    double worst = 0.0;
    for (int n = 0; n < std::lround(0.04 / dt); ++n) {
        run.advance(1);
        wanted.advance(dt);
        if (wanted.slowest < 5e-3L)
            break;
        worst = std::max(worst, static_cast<double>(std::abs(run.rod(0).position.z() - wanted.z)) / drop);
    }
    CHECK_FALSE(run.failure());
    impacts = static_cast<int>(run.tallies().rod_plate);
    return worst;
}

} // namespace

TEST_CASE("a tilted rod that drops bounces when and where it touches, at any time step") {
    for (const double pitch : {0.3, -0.1, 0.02})
        for (const double dt : {1e-5, 3.7e-5, 1e-4}) {
            CAPTURE(pitch, dt);
            int impacts = 0;
            // impacts multiply what the earlier ones left of rounding; at the end of a step they would be off
            // by g dt^2/drop = 1e-6 and more
            CHECK(worst_rod_error(pitch, dt, 0.5, impacts) < 1e-10);
            CHECK(impacts >= 2);
        }
    int impacts = 0;
    CHECK(worst_rod_error(0.3, 1e-4, 0.5 + 1e-8, impacts) > 1e-10); // the integration can tell
}

// --- two beads in free flight
// -------------------------------------------------------------------------------

namespace {

RealVector real(const Vector3& v) { return v.cast<Real>(); }

struct TwoBeads {
    RealVector x[2], v[2];
};

Vector3 place(const State& s, std::size_t i) { return {s.beads.x[i], s.beads.y[i], s.beads.z[i]}; }
Vector3 speed(const State& s, std::size_t i) { return {s.beads.vx[i], s.beads.vy[i], s.beads.vz[i]}; }

/// After `time`, in which two smooth beads meet once: their relative motion knows no gravity.
TwoBeads met(const State& start, Real time, Real restitution) {
    const RealVector r = real(place(start, 0)) - real(place(start, 1)),
                     v = real(speed(start, 0)) - real(speed(start, 1)), fall(0, 0, g);
    const Real reach = 2 * Real(a), along = r.dot(v),
               at = (-along - std::sqrt(along * along - v.dot(v) * (r.dot(r) - reach * reach))) / v.dot(v);
    const RealVector n = (r + v * at) / reach, change = -(1 + restitution) / 2 * n.dot(v) * n;
    TwoBeads after;
    for (const int i : {0, 1}) {
        const RealVector given = (i == 0 ? 1 : -1) * change;
        after.v[i] = real(speed(start, i)) - fall * time + given;
        after.x[i] = real(place(start, i)) + real(speed(start, i)) * time - fall * (time * time / 2) +
                     given * (time - at);
    }
    return after;
}

/// Two beads that pass each other's line at `offset` radii and touch at `at`.
State meeting_beads(double offset, double at) {
    constexpr double approach = 0.2; // 0.05 a in 1e-4 s
    const Vector3 along = Vector3(0.6, 0.48, -0.64), across = Vector3(0.8, -0.36, 0.48);
    const Vector3 common(0.03, -0.02, 0.05), middle(4e-3, 5e-3, 10e-3);
    const Vector3 r = offset * a * across - (std::sqrt(4.0 - offset * offset) * a + approach * at) * along;
    State state;
    state.beads.resize(2);
    for (const int i : {0, 1}) {
        const double side = i == 0 ? 0.5 : -0.5;
        const Vector3 x = middle + side * r, v = common + side * approach * along;
        state.beads.x[i] = x.x(), state.beads.y[i] = x.y(), state.beads.z[i] = x.z();
        state.beads.vx[i] = v.x(), state.beads.vy[i] = v.y(), state.beads.vz[i] = v.z();
    }
    return state;
}

/// Largest distance from the closed form: of places in radii, of velocities in that of the approach.
double distance(const State& state, const TwoBeads& wanted) {
    double worst = 0.0;
    for (const int i : {0, 1}) {
        worst = std::max(worst, static_cast<double>((real(place(state, i)) - wanted.x[i]).norm()) / a);
        worst = std::max(worst, static_cast<double>((real(speed(state, i)) - wanted.v[i]).norm()) / 0.2);
    }
    return worst;
}

} // namespace

TEST_CASE("two beads meet when they touch, wherever in a step that is") {
    constexpr double time = 1e-4;
    for (const double offset : {0.0, 1.0, 1.99}) // head-on, oblique, grazing
        for (const double part : {0.01, 0.3, 0.5, 0.77, 0.99})
            for (const int steps : {1, 2, 5}) {
                CAPTURE(offset, part, steps);
                const State start = meeting_beads(offset, part * time);
                Simulation run(room(2, 0.7, time / steps), start);
                run.advance(steps);
                CHECK(run.tallies().bead_bead == 1);
                // heights of 1e-2 m carry 4e-15 a of rounding, a grazing touch ten times that
                CHECK(distance(run.state(), met(start, time, 0.7L)) < 1e-13);
            }
    const State start = meeting_beads(1.0, 0.5 * time);
    Simulation run(room(2, 0.7, time), start);
    run.advance(1);
    CHECK(distance(run.state(), met(start, time, 0.7L + 1e-11L)) > 1e-13); // the closed form can tell
}

// --- a bead and a rod in free flight
// ------------------------------------------------------------------------

namespace {

struct MeetingOfRod {
    State start;
    Vector3 normal; ///< from the rod to the bead as they touch
    Vector3 arm;    ///< from the rod's centre of mass to there
};

/// A rod without spin and a bead that touch at `at`.
MeetingOfRod meeting_rod(RandomStream& random, const Clump& clump, double at) {
    MeetingOfRod m;
    m.start.beads.resize(1);
    m.start.rods.resize(1);
    RodBody& rod = m.start.rods[0];
    rod.orientation = beds::random_turn(random);
    rod.position = Vector3(6e-3, 5e-3, 10e-3);
    rod.velocity = beds::random_vector(random, 0.05);
    const Vector3 axis = rod.axis();
    m.normal = axis.cross(beds::random_vector(random, 1.0)).normalized();
    const auto sphere = static_cast<std::size_t>(random.uniform(0.0, 11.99));
    m.arm = clump.offset[sphere] * axis + clump.radius[sphere] * m.normal;
    const Vector3 approach = -0.2 * m.normal + 0.05 * axis.cross(m.normal);
    const Vector3 x = rod.position + m.arm + a * m.normal - approach * at, v = rod.velocity + approach;
    m.start.beads.x[0] = x.x(), m.start.beads.y[0] = x.y(), m.start.beads.z[0] = x.z();
    m.start.beads.vx[0] = v.x(), m.start.beads.vy[0] = v.y(), m.start.beads.vz[0] = v.z();
    return m;
}

} // namespace

TEST_CASE("a bead and a rod meet when they touch: momentum, energy and the time of it") {
    RandomStream random(51);
    constexpr double dt = 1e-4;
    GranularProblem problem = room(1, 1.0, dt);
    problem.rods = {beds::long_rod(0.0, 0.0, 0.0)};
    const Clump clump = make_clump(problem.rods[0].shape);
    const double mass = bead_mass(problem);
    const Vector3 fall(0.0, 0.0, g);
    for (const double part : {0.02, 0.3, 0.5, 0.8, 0.98})
        for (int n = 0; n < 20; ++n) {
            CAPTURE(part, n);
            const MeetingOfRod m = meeting_rod(random, clump, part * dt);
            Simulation run(problem, m.start);
            const Energy before = run.energy();
            run.advance(1);
            REQUIRE(run.tallies().bead_rod == 1);
            const Energy after = run.energy();
            CHECK(after.kinetic + after.potential ==
                  Approx(before.kinetic + before.potential).epsilon(1e-14)); // rounding
            // free flight, and from the touch on what the impulse gave
            const State now = run.state();
            const RodBody &rod = now.rods[0], &first = m.start.rods[0];
            const Vector3 given = speed(now, 0) - (speed(m.start, 0) - fall * dt),
                          recoil = rod.velocity - (first.velocity - fall * dt);
            const Vector3 turn = m.arm.cross(m.normal);
            // of a smooth elastic impact: 2 u over the inverse mass along the normal; 0.2 m/s is u
            const double impulse =
                2.0 * 0.2 / (1.0 / mass + 1.0 / clump.mass + turn.squaredNorm() / clump.transverse_inertia);
            CHECK((mass * given - impulse * m.normal).norm() < 1e-13 * impulse);
            CHECK((clump.mass * recoil + impulse * m.normal).norm() < 1e-13 * impulse);
            CHECK((rod.angular_momentum + impulse * turn).norm() < 1e-13 * impulse * clump.reach());
            const auto since = [&](const Vector3& x, const Vector3& x0, const Vector3& v0,
                                   const Vector3& dv) {
                return (x - (x0 + v0 * dt - fall * dt * dt / 2.0)).dot(dv) / dv.squaredNorm();
            };
            // places carry 2e-18 m of rounding, that is 1e-17 s at 0.2 m/s; the rod hardly recoils
            CHECK(std::abs(since(place(now, 0), place(m.start, 0), speed(m.start, 0), given) -
                           (1.0 - part) * dt) < 1e-12 * dt);
            CHECK(std::abs(since(rod.position, first.position, first.velocity, recoil) - (1.0 - part) * dt) <
                  1e-11 * dt);
        }
    // the time tells a meeting that is off by 1e-10 of a step
    const MeetingOfRod m = meeting_rod(random, clump, (0.5 + 1e-10) * dt);
    Simulation run(problem, m.start);
    run.advance(1);
    const Vector3 given = speed(run.state(), 0) - (speed(m.start, 0) - fall * dt),
                  way = place(run.state(), 0) -
                        (place(m.start, 0) + speed(m.start, 0) * dt - fall * dt * dt / 2.0);
    CHECK(std::abs(way.dot(given) / given.squaredNorm() - 0.5 * dt) > 1e-11 * dt);
}
