// Boxes whose sides differ: lattices that close in them, starts, energy, threads, and the bed mirrored.

#include "beds.hpp"
#include "granular/packing.hpp"
#include "rodwake/core/error.hpp"
#include "starts.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

const double a = starts::a;

/// The box of a perfect lattice of so many sites a row and rows, rows along x.
PeriodicBox perfect_box(int in_row, int rows, double spacing) {
    return {in_row * spacing, rows * spacing * std::sqrt(0.75)};
}

GranularProblem dense_bed(const PeriodicBox& box, double phi_b, Start start) {
    GranularProblem problem;
    problem.box = box;
    problem.beads = static_cast<std::size_t>(std::lround(phi_b * box.area() / (M_PI * a * a)));
    problem.start = start;
    return problem;
}

/// x and y exchanged: a reflection, under which velocities are vectors and rates of turn are not.
State mirrored(const State& state) {
    State m = state;
    std::swap(m.beads.x, m.beads.y);
    std::swap(m.beads.vx, m.beads.vy);
    std::swap(m.beads.wx, m.beads.wy);
    for (auto* rates : {&m.beads.wx, &m.beads.wy, &m.beads.wz})
        for (double& w : *rates)
            w = -w;
    Eigen::Matrix3d mirror;
    mirror << 0, 1, 0, 1, 0, 0, 0, 0, 1;
    const Eigen::Vector3d of_body(1.0, -1.0, 1.0); // rods are round: their own mirror image
    for (RodBody& rod : m.rods) {
        rod.position = mirror * rod.position;
        rod.velocity = mirror * rod.velocity;
        rod.angular_momentum = -(mirror * rod.angular_momentum);
        rod.orientation =
            Eigen::Quaterniond(Eigen::Matrix3d(mirror * rod.orientation * of_body.asDiagonal()));
    }
    return m;
}

double furthest_apart(const State& one, const State& two) {
    double worst = 0.0;
    for (std::size_t i = 0; i < one.beads.size(); ++i)
        worst =
            std::max({worst, std::abs(one.beads.x[i] - two.beads.x[i]),
                      std::abs(one.beads.y[i] - two.beads.y[i]), std::abs(one.beads.z[i] - two.beads.z[i])});
    for (std::size_t k = 0; k < one.rods.size(); ++k)
        worst = std::max(worst, (one.rods[k].position - two.rods[k].position).norm());
    return worst;
}

} // namespace

TEST_CASE("a rectangle that a perfect lattice fills gets it, along either side") {
    const PeriodicBox box = perfect_box(37, 42, 2.1);
    const auto fit = fit_lattice(box, 1554, 0.0);
    CHECK(fit.sites == 1554);
    CHECK(fit.strain < 1e-14); // rounding
    CHECK(fit.spacing == Approx(2.1).epsilon(1e-14));
    CHECK(std::abs(fit.orientation) < 1e-14);
    const auto across = fit_lattice({box.y, box.x}, 1554, 0.5 * M_PI);
    CHECK(across.sites == 1554);
    CHECK(across.strain < 1e-14);
    CHECK(across.orientation == Approx(0.5 * M_PI).epsilon(1e-14));
    CHECK(fit_lattice(box, 1554, 0.5 * M_PI).strain >
          0.005); // rows across do not close in it: the test can fail
}

TEST_CASE("a lattice's own box is the nearest to a square, rows along either side") {
    const LatticeBox found = lattice_box(1549.3, 1, 0.0), across = lattice_box(1549.3, 1, 0.5 * M_PI);
    CHECK(found.in_row == 37);
    CHECK(found.rows == 42);
    CHECK(found.box.area() == Approx(1.0).epsilon(1e-15));
    CHECK(found.box.x / found.box.y == Approx(37 / (42 * std::sqrt(0.75))).epsilon(1e-14));
    CHECK(across.box.x == found.box.y);
    CHECK(across.box.y == found.box.x);
    CHECK(across.row_ratio() == Approx(std::sqrt(0.75)).epsilon(1e-14));
    CHECK(lattice_box(1549.3, 1, M_PI / 3.0).rows_along_y == false);
    CHECK(lattice_box(1549.3, 1, M_PI / 6.0).rows_along_y);
    CHECK(lattice_box(1549.3, 1600, 0.0).sites() >= 1600);
    CHECK(with_area(found, 7.0).box.area() == Approx(7.0).epsilon(1e-15));
    CHECK_THROWS_AS(lattice_box(1549.3, 1, 0.1), InputError);
    CHECK_THROWS_AS(lattice_box(3.0, 1, 0.0), InputError);
}

TEST_CASE("sites of a lattice in a rectangle are complete and inside") {
    const PeriodicBox box{3.0, 1.9};
    const auto fit = fit_lattice(box, 97, 0.4);
    const auto sites = lattice_sites(fit, box);
    REQUIRE(sites.size() == static_cast<std::size_t>(fit.sites));
    double nearest = HUGE_VAL;
    for (std::size_t i = 0; i < sites.size(); ++i) {
        CHECK((sites[i].x() >= 0.0 && sites[i].x() < box.x && sites[i].y() >= 0.0 && sites[i].y() < box.y));
        for (std::size_t j = i + 1; j < sites.size(); ++j)
            nearest = std::min(
                nearest, nearest_distance(sites[i].x() - sites[j].x(), sites[i].y() - sites[j].y(), box));
    }
    CHECK(nearest == Approx(fit.spacing).epsilon(1e-12));
}

TEST_CASE("beds start without overlap in rectangles, rods across both edges") {
    for (const PeriodicBox box : {PeriodicBox(50 * a, 30 * a), PeriodicBox(24 * a, 60 * a)})
        for (const Start start : {Start::lattice, Start::random}) {
            GranularProblem problem = dense_bed(box, start == Start::lattice ? 0.72 : 0.6, start);
            problem.rods.push_back(beds::long_rod(0.2 * a, box.y / 2.0, 0.1));
            problem.rods.push_back(beds::long_rod(box.x / 2.0, box.y - 0.3 * a, 1.5));
            starts::check_start(problem);
        }
}

TEST_CASE("a run in a rectangle has the same bits for any number of threads, and misses no overlap",
          "[threads]") {
    GranularProblem problem = dense_bed({130 * a, 95 * a}, 0.78, Start::lattice); // 3066 beads: two blocks
    problem.rods.push_back(beds::long_rod(0.5 * a, 0.5 * a, 0.7));
    const State start = make_start(problem, 0);
    Simulation one(problem, start, {}, 1), three(problem, start, {}, 3);
    one.advance(300);
    three.advance(300);
    CHECK_FALSE(one.failure());
    CHECK(state_hash(one.state()) == state_hash(three.state()));
    const auto left = beds::all_overlaps(beds::bodies_of(one), problem.box);
    CHECK(left.size() < problem.beads / 5); // those that met within the last step
    CHECK(one.tallies().max_overlap < 0.05);
}

TEST_CASE("an elastic bed in a rectangle keeps its energy") {
    GranularProblem problem = beds::still_plates(1.2e-3, {60 * a, 35 * a});
    problem.beads = 420;
    problem.rods.push_back(beds::long_rod(1 * a, 1 * a, 0.3));
    problem.start_speed = 0.1;
    beds::set_contacts(problem, {0.0, 1.0});
    Simulation run(problem, make_start(problem, 0));
    const auto total = [&] { return run.energy().kinetic + run.energy().potential; };
    const double before = total();
    run.advance(2000);
    CHECK_FALSE(run.failure());
    CHECK(run.tallies().bead_bead > 100);
    CHECK(std::abs(total() / before - 1.0) < 1e-11); // as in the square (test_simulation.cpp)
}

TEST_CASE("a rectangle turned by 90 degrees gives the mirrored run") {
    GranularProblem problem = dense_bed({44 * a, 31 * a}, 0.74, Start::lattice), across = problem;
    problem.rods.push_back(beds::long_rod(43 * a, 12 * a, 0.2));
    across.box = {problem.box.y, problem.box.x};
    across.rods.push_back(beds::long_rod(12 * a, 43 * a, 0.5 * M_PI - 0.2));
    const State start = make_start(problem, 0);
    Simulation run(problem, start), turned(across, mirrored(start));
    run.advance(200); // impacts double what rounding makes of them every few steps
    turned.advance(200);
    CHECK(run.tallies().bead_bead > 200);
    CHECK(run.tallies().bead_bead == turned.tallies().bead_bead);
    CHECK(run.tallies().bead_rod == turned.tallies().bead_rod);
    CHECK(furthest_apart(mirrored(run.state()), turned.state()) < 1e-7 * a);
}
