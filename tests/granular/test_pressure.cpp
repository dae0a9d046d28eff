// The pressure tensor: single impulses by hand, gases of hard discs and of flat layers of spheres by theory.

#include "beds.hpp"
#include "rodwake/granular/record.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

const double a = GranularProblem{}.bead_radius;

/// Two beads that meet head-on across the edge of the box, their line turned by `angle` from x.
Simulation head_on(double angle, double speed) {
    GranularProblem problem = beds::still_plates(3e-3, PeriodicBox(40 * a, 50 * a));
    problem.gravity = 0.0;
    problem.beads = 2;
    beds::set_contacts(problem, {0.0, 1.0});
    State state;
    state.beads.resize(2);
    Beads& b = state.beads;
    for (const int i : {0, 1}) {
        const double side = i == 0 ? 1.0 : -1.0, apart = 1.2 * a;
        b.x[i] = side * apart * std::cos(angle) + (i == 0 ? 0.0 : problem.box.x);
        b.y[i] = side * apart * std::sin(angle);
        b.z[i] = 1.5e-3;
        b.vx[i] = -side * speed * std::cos(angle);
        b.vy[i] = -side * speed * std::sin(angle);
    }
    return {problem, state};
}

/// Elastic, frictionless beads between still plates without gravity; p A/(sum of m v^2 in one direction).
double compressibility(double gap, double phi, std::int64_t steps) {
    GranularProblem problem = beds::still_plates(gap, 60 * a);
    problem.gravity = 0.0;
    problem.beads = static_cast<std::size_t>(std::lround(phi * 3600.0 / M_PI));
    problem.start_speed = 0.1;
    problem.time_step = 1e-4;
    problem.start = Start::random;
    problem.equilibration_steps = 2000;
    beds::set_contacts(problem, {0.0, 1.0});
    Simulation run(problem, make_start(problem, 0));
    run.advance(problem.equilibration_steps);
    const PlaneTensor before = run.tallies().virial;
    PlaneTensor flux{}, virial{};
    const std::int64_t samples = steps / 10;
    for (std::int64_t k = 0; k < samples; ++k) {
        run.advance(10);
        for (std::size_t i = 0; i < 3; ++i)
            flux[i] += run.agitation().momentum_flux[i] / static_cast<double>(samples);
    }
    REQUIRE_FALSE(run.failure());
    CHECK(run.tallies().bead_bead > 10'000);
    for (std::size_t i = 0; i < 3; ++i)
        virial[i] = run.tallies().virial[i] - before[i];
    const double area = problem.box.area(), time = static_cast<double>(steps) * problem.time_step;
    const PlaneTensor p = pressure(flux, virial, time, area);
    // isotropic, but for the scatter of 10^4 impulses
    CHECK(p[1] / p[0] == Approx(0.0).margin(0.02));
    CHECK(p[2] / p[0] == Approx(1.0).margin(0.03));
    return area * isotropic(p) / isotropic(flux);
}

} // namespace

TEST_CASE("an impulse between beads carries its momentum over their distance") {
    for (const double angle : {0.0, 0.3, M_PI / 2.0, 2.0}) {
        Simulation run = head_on(angle, 0.1);
        run.advance(1000);
        REQUIRE(run.tallies().bead_bead == 1);
        const double impulse = 2.0 * bead_mass(run.problem()) * 0.1; // elastic: twice the momentum of one
        const double c = std::cos(angle), s = std::sin(angle), size = 2.0 * a * impulse;
        CAPTURE(angle);
        const PlaneTensor expected{size * c * c, size * c * s, size * s * s};
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(run.tallies().virial[k] == Approx(expected[k]).margin(1e-12 * size)); // rounding of places
    }
}

TEST_CASE("the flux of momentum is that of bodies about the motion of the beads") {
    GranularProblem problem;
    problem.beads = 200;
    problem.box = 45 * a;
    problem.rods.push_back(beds::long_rod(20 * a, 20 * a, 0.3));
    State state = make_start(problem, 0);
    for (std::size_t i = 0; i < 200; ++i)
        state.beads.vy[i] += 0.4; // all together
    state.rods[0].velocity = {0.01, 0.43, 0.2};
    double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t i = 0; i < 200; ++i) {
        mean_x += state.beads.vx[i] / 200.0;
        mean_y += state.beads.vy[i] / 200.0;
    }
    const auto include = [&](double mass, double vx, double vy) {
        xx += mass * (vx - mean_x) * (vx - mean_x);
        xy += mass * (vx - mean_x) * (vy - mean_y);
        yy += mass * (vy - mean_y) * (vy - mean_y);
    };
    for (std::size_t i = 0; i < 200; ++i)
        include(bead_mass(problem), state.beads.vx[i], state.beads.vy[i]);
    include(make_clump(problem.rods[0].shape).mass, 0.01, 0.43);
    const PlaneTensor flux = Simulation(problem, state).agitation().momentum_flux;
    CHECK(flux[0] == Approx(xx).epsilon(1e-12)); // rounding of 0.4 in velocities of 0.02
    CHECK(flux[1] == Approx(xy).margin(1e-12 * xx));
    CHECK(flux[2] == Approx(yy).epsilon(1e-12));
}

// Z = 1 + sum B_k: virial coefficients of hard discs in powers of the area fraction (Clisby & McCoy, J. Stat.
// Phys. 122, 15, 2006). The scatter of 10^4 impulses is 1 to 1.5 % of Z - 1, here 0.9.
TEST_CASE("a layer too flat to leave the plane has the pressure of hard discs") {
    constexpr double coefficients[] = {2.0,      3.128018, 4.257854, 5.336897, 6.363026,
                                       7.352080, 8.318668, 9.272360, 10.2163};
    const double phi = 0.3;
    double Z = 1.0, power = 1.0;
    for (const double B : coefficients)
        Z += B * (power *= phi);
    CHECK(compressibility(2.0 * a * 1.0001, phi, 10'000) == Approx(Z).epsilon(0.015));
}

// Two spheres whose heights differ by h exclude the area pi (4 a^2 - h^2); heights are even over a height H =
// w - 2 a, so B = (pi/2)(4 a^2 - H^2/6). The third coefficient is that of discs, which counts 0.3 % here.
TEST_CASE("a dilute layer of spheres has the second virial coefficient of its gap") {
    const double gap = 3.6 * a, phi = 0.06, height = gap / a - 2.0;
    const double second = phi * (2.0 - height * height / 12.0);
    CHECK(second < 0.92 * 2.0 * phi); // discs would have another
    const double Z = compressibility(gap, phi, 200'000);
    CHECK(Z - 1.0 == Approx(second + 3.128 * phi * phi).epsilon(0.04));
}

TEST_CASE("rods take part in the pressure") {
    GranularProblem problem = beds::still_plates(1.2e-3, 60 * a);
    problem.beads = 300;
    problem.start_speed = 0.1;
    problem.rods.push_back(beds::long_rod(30 * a, 30 * a, 0.0));
    Simulation with(problem, make_start(problem, 0));
    double last = 0.0;
    std::int64_t seen = 0;
    for (int k = 0; k < 2000 && seen < 5; ++k) { // steps in which the rod is hit and no two beads meet
        const Counters before = with.tallies();
        with.advance(1);
        const Counters& now = with.tallies();
        if (now.bead_rod == before.bead_rod || now.bead_bead != before.bead_bead)
            continue;
        ++seen;
        const double carried = now.virial[0] + now.virial[2] - before.virial[0] - before.virial[2];
        CHECK(carried != 0.0);
        last += carried;
    }
    CHECK(seen == 5);
    CHECK(last > 0.0); // bodies push each other apart
}

TEST_CASE("the pressure is flux and virial over time and area; without time the flux alone") {
    CHECK(pressure({1.0, 2.0, 3.0}, {}, 0.0, 0.5) == PlaneTensor{2.0, 4.0, 6.0});
    CHECK(pressure({1.0, 2.0, 3.0}, {4.0, 6.0, 8.0}, 2.0, 0.5) == PlaneTensor{6.0, 10.0, 14.0});
}
