// Starts: nothing overlaps (looked at pair by pair), the right numbers, and the same state for the same seed.

#include "starts.hpp"

#include "granular/packing.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace starts;
using namespace rodwake;
using Eigen::Vector2d;
using granular::fit_lattice;
using granular::LatticeFit;
using granular::restart_from;

TEST_CASE("a bed settles slower the denser it is, and fastest from a lattice") {
    using granular::settling_time;
    using granular::Start;
    CHECK(settling_time(Start::lattice, 0.8) == 0.5);
    for (const auto& [phi_b, time] : {std::pair{0.0, 1.0},
                                      {0.60, 1.0},
                                      {0.65, 1.5},
                                      {0.70, 2.0},
                                      {0.71, 5.0},
                                      {0.72, 8.0},
                                      {0.76, 10.0},
                                      {0.78, 17.0},
                                      {0.80, 24.0},
                                      {0.9, 24.0}})
        CHECK(settling_time(Start::random, phi_b) == Approx(time).epsilon(1e-13)); // rounding of phi_b
}

TEST_CASE("a lattice start overlaps nowhere, from thin to nearly closest packing, at any angle") {
    for (const double phi : {0.05, 0.3, 0.7, 0.8, 0.88})
        for (const double orientation : {0.0, 0.5 * M_PI, 0.3}) {
            auto problem = bed(phi, Start::lattice);
            problem.orientation = orientation;
            check_start(problem);
        }
}

TEST_CASE("rods find room in a lattice") {
    for (const double phi : {0.05, 0.8, 0.88})
        for (const double heading : {0.0, 1.1}) {
            auto problem = bed(phi, Start::lattice);
            add_rod(problem, 20, 46.5, heading);
            add_rod(problem, 77, 1, -heading); // across the edge of the box
            problem.rods[1].imposed_speed = 1e-3;
            check_start(problem);
        }
}

TEST_CASE("a random start overlaps nowhere, with and without rods, in thick and thin layers") {
    for (const double phi : {0.05, 0.5, 0.8, 0.85}) {
        auto problem = bed(phi, Start::random);
        check_start(problem);
        add_rod(problem, 20, 46.5, 0.5);
        add_rod(problem, 0, 0, 2.0);
        check_start(problem);
    }
    auto thin = bed(0.8, Start::random);
    thin.plates.gap = 2.001 * a; // beads cannot pass over each other
    check_start(thin);
}

TEST_CASE("the search for overlaps sees beads, rods and plates") {
    auto problem = bed(0.5, Start::lattice, 30.0);
    add_rod(problem, 10, 10, 0.4);
    const State sound = make_start(problem, 0);
    REQUIRE(clearance(sound, problem) > 0.0);
    State state = sound;
    state.beads.x[3] = state.beads.x[0] + 1.999 * a + 5 * problem.box.x; // an image
    state.beads.y[3] = state.beads.y[0];
    CHECK(clearance(state, problem) < 0.0);
    state = sound;
    state.beads.x[3] = 10 * a;
    state.beads.y[3] = 10 * a;
    CHECK(clearance(state, problem) < -a);
    state = sound;
    state.beads.z[3] = floor_height(problem) + 0.999 * a;
    CHECK(clearance(state, problem) == Approx(-0.001 * a).epsilon(1e-9)); // rounding of z over 1e-3 a
    state = sound;
    state.rods[0].position.z() =
        floor_height(problem) + 0.66e-3; // 0.05 mm is free above the thick end at mid gap
    CHECK(clearance(state, problem) == Approx(-0.01e-3).epsilon(1e-9));
}

TEST_CASE("small boxes and single bodies start too") {
    for (const double phi : {0.05, 0.3, 0.6})
        check_start(bed(phi, Start::lattice, 8.0));
    check_start(bed(0.7, Start::random, 9.0));
    GranularProblem lone;
    add_rod(lone, 39, 39, 1.0);
    check_start(lone);
    auto crowd = bed(0.3, Start::lattice, 78.0);
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 15; ++j)
            add_rod(crowd, 7.0 + 15 * i, 5 * j, i % 2 * M_PI);
    check_start(crowd);
}

TEST_CASE("what cannot be packed is said, with the density and what to try") {
    auto full = bed(0.9, Start::random, 30.0);
    full.plates.gap = 2.001 * a; // a flat random layer of 0.9 does not exist
    CHECK_THROWS_WITH(make_start(full, 0), Catch::Contains("phi_b = 0.9") && Catch::Contains("bead radii") &&
                                               Catch::Contains("start = \"lattice\""));
    CHECK_THROWS_AS(make_start(full, 0), RunError);
    CHECK_THROWS_AS(make_start(bed(0.95, Start::lattice), 0), InputError);
}

TEST_CASE("beads lie near the middle of the gap, wherever the plates are at the start") {
    for (const std::int64_t equilibration : {0, 30, 125, 1'000'000'007}) {
        auto problem = bed(0.7, Start::lattice);
        problem.equilibration_steps = equilibration;
        add_rod(problem, 20, 46.5, 0.7);
        const State state = make_start(problem, 0);
        // 1e9 steps are 4e6 periods: the phase is good to 4e6 * 2 pi * 1e-16
        const double middle = floor_height(problem) + 0.6e-3;
        CHECK(std::abs(state.rods[0].position.z() - middle) < 0.01 * 0.1e-3 + 1e-8 * middle);
        CHECK(state.rods[0].heading() == Approx(0.7).epsilon(1e-14));
        CHECK(state.rods[0].velocity.head<2>().norm() + std::abs(state.rods[0].angular_momentum.z()) == 0.0);
        CHECK(*std::max_element(state.beads.z.begin(), state.beads.z.end()) < middle + 0.01 * 0.2e-3 + 1e-12);
        CHECK(clearance(state, problem) > 0.0);
    }
}

TEST_CASE("velocities are normal, with the asked spread and no mean") {
    const auto problem = bed(0.8, Start::lattice, 200.0);
    const State state = make_start(problem, 0);
    const double n = static_cast<double>(problem.beads), s = problem.start_speed;
    for (const auto* v : {&state.beads.vx, &state.beads.vy, &state.beads.vz}) {
        CHECK(std::abs(mean(*v, 1)) < 1e-15 * s * n);                          // rounding of the sum
        CHECK(mean(*v, 2) == Approx(s * s).epsilon(4.0 * std::sqrt(2.0 / n))); // four standard errors
        CHECK(mean(*v, 4) == Approx(3.0 * s * s * s * s).epsilon(4.0 * std::sqrt(96.0 / n) / 3.0));
    }
    double product = 0.0;
    for (std::size_t i = 0; i < problem.beads; ++i)
        product += state.beads.vx[i] * state.beads.vy[i] / (n * s * s);
    CHECK(std::abs(product) < 4.0 / std::sqrt(n));
    CHECK(mean(state.beads.wx, 2) + mean(state.beads.wy, 2) + mean(state.beads.wz, 2) == 0.0);
}

TEST_CASE("a start depends on seed and run only") {
    for (const Start kind : {Start::lattice, Start::random}) {
        auto problem = bed(0.75, kind);
        add_rod(problem, 20, 46.5, 0.5);
        const auto first = state_hash(make_start(problem, 3));
        CHECK(state_hash(make_start(problem, 3)) == first);
        CHECK(state_hash(make_start(problem, 4)) != first);
        problem.seed = 2;
        CHECK(state_hash(make_start(problem, 3)) != first);
    }
}

TEST_CASE("rods lie a little off mid gap and move up or down, each in its own way in each run") {
    GranularProblem problem;
    add_rod(problem, 20, 20, 0.0);
    add_rod(problem, 20, 40, 1.0);
    problem.rods[1].imposed_speed = 1e-3;
    const double middle = floor_height(problem) + 0.6e-3, most = 0.01 * 0.1e-3; // 0.1 mm is free
    std::vector<double> height, speed, pitch, roll;
    const rodwake::granular::Clump clump = rodwake::granular::make_clump({});
    const double pitch_unit = clump.transverse_inertia * problem.start_speed / clump.reach();
    const double roll_unit = clump.axial_inertia * problem.start_speed / 0.55e-3;
    for (std::uint32_t run = 0; run < 500; ++run)
        for (const auto& rod : make_start(problem, run).rods) {
            const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(rod.axis());
            pitch.push_back(rod.angular_momentum.dot(across) / pitch_unit);
            roll.push_back(rod.angular_momentum.dot(rod.axis()) / roll_unit);
            height.push_back((rod.position.z() - middle) / most);
            speed.push_back(rod.velocity.z() / problem.start_speed);
        }
    const double n = static_cast<double>(height.size());
    CHECK(*std::max_element(height.begin(), height.end()) < 1.0);
    CHECK(*std::min_element(height.begin(), height.end()) > -1.0);
    // Four standard errors of the moments of a uniform and of a normal number.
    CHECK(std::abs(mean(height, 1)) < 4.0 / std::sqrt(3.0 * n));
    CHECK(std::abs(mean(height, 2) - 1.0 / 3.0) < 4.0 * std::sqrt(4.0 / 45.0 / n));
    CHECK(std::abs(mean(speed, 1)) < 4.0 / std::sqrt(n));
    CHECK(std::abs(mean(speed, 2) - 1.0) < 4.0 * std::sqrt(2.0 / n));
    for (const auto* turning : {&pitch, &roll}) {
        CHECK(std::abs(mean(*turning, 1)) < 4.0 / std::sqrt(n));
        CHECK(std::abs(mean(*turning, 2) - 1.0) < 4.0 * std::sqrt(2.0 / n));
    }
    std::sort(speed.begin(), speed.end());
    CHECK(std::adjacent_find(speed.begin(), speed.end()) == speed.end());
    problem.start_speed = 0.0;
    CHECK(make_start(problem, 0).rods[1].velocity.norm() == 0.0);
    problem.seed = 2;
    CHECK(make_start(problem, 0).rods[1].position.z() != make_start(problem, 1).rods[1].position.z());
}

TEST_CASE("numbers of a bead do not depend on how many others there are") {
    auto few = bed(0.1, Start::random), many = bed(0.2, Start::random);
    const State small = make_start(few, 0), large = make_start(many, 0);
    for (std::size_t i = 1; i < few.beads; ++i) // differences: the means that are removed are not the same
        REQUIRE(small.beads.vx[i] - small.beads.vx[0] ==
                Approx(large.beads.vx[i] - large.beads.vx[0]).margin(1e-16));
}

TEST_CASE("a hundred thousand beads start at random", "[.][long]") {
    auto problem = bed(0.8, Start::random, 626.0);
    add_rod(problem, 300, 300, 0.5);
    REQUIRE(problem.beads > 99'000);
    check_start(problem);
}

// --- Starts from the bed of an earlier run

namespace {

/// A bed as an earlier run may have left it: beads many boxes away, each marked by its spin, and other rods.
State left_behind(const GranularProblem& problem) {
    State stored = make_start(problem, 7);
    stored.step = 1000;
    stored.rods.resize(3);
    for (std::size_t i = 0; i < stored.beads.size(); ++i) {
        stored.beads.x[i] += problem.box.x * static_cast<double>(i % 7) - 3.0 * problem.box.x;
        stored.beads.y[i] -= problem.box.y * static_cast<double>(i % 3);
        stored.beads.z[i] += 1.0;
        stored.beads.wx[i] = static_cast<double>(i);
    }
    return stored;
}

/// Which beads of the stored bed are still there.
std::set<std::size_t> marks(const State& state) {
    std::set<std::size_t> found;
    for (const double mark : state.beads.wx)
        found.insert(static_cast<std::size_t>(mark));
    return found;
}

} // namespace

TEST_CASE("a restart takes beads where and as they were, and drops the surplus at random") {
    auto problem = bed(0.7, Start::lattice);
    const State stored = left_behind(problem);
    problem.beads -= 20;
    problem.equilibration_steps = 30;
    const State state = restart_from(problem, stored, 0);
    CHECK(state.step == 0);
    CHECK(state.rods.empty());
    REQUIRE(state.beads.size() == problem.beads);
    CHECK(clearance(state, problem) > 0.0);
    CHECK(marks(state).size() == problem.beads);
    const double middle = floor_height(problem) + 0.6e-3;
    for (std::size_t i = 0; i < problem.beads; ++i) {
        const auto from = static_cast<std::size_t>(state.beads.wx[i]);
        // The lattice is open, so nobody is moved; wrapping rounds at the size of a few boxes.
        REQUIRE(nearest(state.beads.x[i], folded(stored.beads.x[from], problem.box.x), problem.box.x) <
                1e-16);
        REQUIRE(nearest(state.beads.y[i], folded(stored.beads.y[from], problem.box.y), problem.box.y) <
                1e-16);
        REQUIRE(std::abs(state.beads.z[i] - middle) < 0.01 * 0.2e-3 + 1e-12);
        REQUIRE(state.beads.vx[i] == stored.beads.vx[from]);
        REQUIRE(state.beads.vz[i] == stored.beads.vz[from]);
    }
    CHECK(marks(restart_from(problem, stored, 1)) != marks(state));
    CHECK(state_hash(restart_from(problem, stored, 0)) == state_hash(state));
}

TEST_CASE("a restart makes room for rods: the most covered beads go first") {
    const double phi = GENERATE(0.7, 0.8);
    auto problem = bed(phi, Start::lattice);
    const State stored = left_behind(problem);
    add_rod(problem, 20, 46.5, 0.4);
    add_rod(problem, 77, 1, 1.0);
    // Depth of each stored bead under the rods, in plan view.
    std::vector<double> depth;
    auto only_rods = problem;
    only_rods.beads = 0;
    const State rods = make_start(only_rods, 0);
    for (std::size_t i = 0; i < stored.beads.size(); ++i) {
        double deepest = -1.0;
        for (const Ball& ball : balls_of(rods, only_rods)) {
            const double x = nearest(folded(ball.x, problem.box.x), folded(stored.beads.x[i], problem.box.x),
                                     problem.box.x);
            const double y = nearest(folded(ball.y, problem.box.y), folded(stored.beads.y[i], problem.box.y),
                                     problem.box.y);
            deepest = std::max(deepest, ball.radius + a - std::hypot(x, y));
        }
        depth.push_back(deepest);
    }
    const auto covered =
        static_cast<std::size_t>(std::count_if(depth.begin(), depth.end(), [](double d) { return d > 0.0; }));
    REQUIRE(covered > 12);
    problem.beads -= 12; // fewer than are covered: the others are pushed aside
    const State state = restart_from(problem, stored, 0);
    CHECK(clearance(state, problem) > 0.0);
    REQUIRE(state.rods.size() == 2);
    CHECK(state.rods[0].heading() == Approx(0.4).epsilon(1e-14));
    const auto kept = marks(state);
    double shallowest_gone = 1.0, deepest_kept = -1.0;
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (kept.count(i) == 0)
            shallowest_gone = std::min(shallowest_gone, depth[i]);
        else
            deepest_kept = std::max(deepest_kept, depth[i]);
    CHECK(shallowest_gone >= deepest_kept);
    problem.beads -= covered; // more than are covered: none of them is left
    for (const std::size_t i : marks(restart_from(problem, stored, 0)))
        REQUIRE(depth[i] <= 0.0);
}

TEST_CASE("a restart from a bed that does not fit says why") {
    auto problem = bed(0.7, Start::lattice, 30.0);
    const State stored = left_behind(problem);
    auto more = problem;
    more.beads += 5;
    CHECK_THROWS_WITH(restart_from(more, stored, 0),
                      Catch::Contains(std::to_string(problem.beads) + " beads") &&
                          Catch::Contains(std::to_string(more.beads)));
    CHECK_THROWS_AS(restart_from(more, stored, 0), InputError);
    State damaged = stored;
    damaged.beads.vy[17] = std::nan("");
    CHECK_THROWS_WITH(restart_from(problem, damaged, 0), Catch::Contains("bead 17"));
    auto smaller = problem;
    smaller.box =
        0.885 * smaller.box.x; // beads in disorder cover 0.7/0.783 = 0.894 of it: only a crystal would fit
    smaller.plates.gap = 2.001 * a;
    CHECK_THROWS_WITH(restart_from(smaller, stored, 0), Catch::Contains("same size"));
    CHECK_THROWS_AS(restart_from(smaller, stored, 0), RunError);
    GranularProblem lone;
    add_rod(lone, 20, 20, 0.0);
    CHECK(restart_from(lone, stored, 0).rods.size() == 1);
}

// --- Triangular lattices in a square box: closed, complete, evenly spaced and as little strained as they say

namespace {

constexpr double degree = M_PI / 180.0;

/// From the first site to all others and to the images of all, sorted by length.
std::vector<Vector2d> steps_from_first(const std::vector<Vector2d>& sites, std::size_t first, double box) {
    std::vector<Vector2d> steps;
    for (std::size_t k = 0; k < sites.size(); ++k)
        for (int i = -1; i <= 1; ++i)
            for (int j = -1; j <= 1; ++j)
                if (k != first || i != 0 || j != 0)
                    steps.push_back(sites[k] - sites[first] + box * Vector2d(i, j));
    std::sort(steps.begin(), steps.end(), [](const auto& u, const auto& v) { return u.norm() < v.norm(); });
    return steps;
}

/// Largest difference between the neighbourhoods of any two sites: 0 for a lattice.
double unevenness(const std::vector<Vector2d>& sites, double box) {
    double worst = 0.0;
    const auto reference = steps_from_first(sites, 0, box);
    for (std::size_t k = 1; k < sites.size(); ++k) {
        const auto here = steps_from_first(sites, k, box);
        for (std::size_t n = 0; n < 12; ++n)
            worst = std::max(worst, std::abs(here[n].norm() - reference[n].norm()));
    }
    return worst;
}

double turned_from(const LatticeFit& fit, double wanted) {
    return std::abs(std::remainder(fit.orientation - wanted, 2.0 * M_PI));
}

} // namespace

TEST_CASE("the bed of the paper is 37 columns and 42 rows, turned by 90 degrees its transpose") {
    const auto fit = fit_lattice(78.0, 1549, 0.0);
    CHECK(fit.sites == 1554);
    CHECK(fit.orientation == 0.0);
    CHECK(fit.spacing == Approx(78.0 / 37.0).epsilon(1e-14)); // rounding
    // rows are 1/42 apart, sites in them 1/37; a perfect triangle has sqrt(3)/2 of that
    CHECK(fit.strain == Approx(std::sqrt(37.0 / 42.0 / std::sqrt(0.75)) - 1.0).epsilon(1e-12));
    const auto across = fit_lattice(78.0, 1549, 0.5 * M_PI);
    CHECK(across.sites == 1554);
    CHECK(across.orientation == Approx(0.5 * M_PI).epsilon(1e-14));
    CHECK(across.strain == Approx(fit.strain).epsilon(1e-10));
    CHECK(across.spacing == Approx(fit.spacing).epsilon(1e-14));
}

TEST_CASE("rows come out within a degree of any wanted angle in the paper's box") {
    for (int k = -12; k <= 12; ++k)
        for (const long beads : {1317L, 1452L, 1549L, 1704L}) {
            const double wanted = k * 5.0 * degree;
            const auto fit = fit_lattice(78.0, beads, wanted);
            INFO(beads << " sites at " << k * 5 << " degrees");
            CHECK(turned_from(fit, wanted) < 1.0 * degree);
            CHECK(fit.sites >= beads);
            CHECK(100 * fit.sites <= 105 * beads); // "a few percent more"
            CHECK(fit.strain < 0.02);              // one row in 78/2.1 = 37 is 2.7 %
        }
}

TEST_CASE("there is a lattice for every number of sites") {
    for (const double wanted : {0.0, 0.3, 1.0, -2.5})
        for (long sites = 1; sites < 400; sites += 1 + sites / 50) {
            const auto fit = fit_lattice(1.0, sites, wanted);
            INFO(sites << " sites at " << wanted);
            REQUIRE(fit.sites >= sites);
            REQUIRE(static_cast<double>(fit.sites) <=
                    1.04 * static_cast<double>(sites) + 2 * std::sqrt(sites) + 2);
            REQUIRE(fit.spacing >
                    0.75 * std::sqrt(2.0 / (std::sqrt(3.0) * static_cast<double>(sites)))); // seen: 0.80
        }
}

TEST_CASE("sites are complete, inside the box and all alike") {
    for (const double wanted : {0.0, 0.2, 0.5 * M_PI, 2.0})
        for (const long least : {1L, 2L, 25L, 97L, 150L}) {
            const auto fit = fit_lattice(3.0, least, wanted);
            const auto sites = granular::lattice_sites(fit, 3.0);
            INFO(least << " sites at " << wanted);
            REQUIRE(static_cast<long>(sites.size()) == fit.sites);
            for (const auto& site : sites)
                REQUIRE((site.minCoeff() >= 0.0 && site.maxCoeff() < 3.0));
            const auto steps = steps_from_first(sites, 0, 3.0);
            CHECK(steps[0].norm() ==
                  Approx(fit.spacing).epsilon(1e-12)); // rounding; no two sites in one place
            if (least < 25) // the twelve nearest may be further than the images looked at
                continue;
            CHECK(unevenness(sites, 3.0) < 1e-13);
            const bool has_row = std::any_of(steps.begin(), steps.begin() + 6, [&](const Vector2d& step) {
                return std::abs(std::remainder(std::atan2(step.y(), step.x()) - fit.orientation,
                                               2.0 * M_PI)) < 1e-12;
            });
            CHECK(has_row); // one of the six nearest lies along the row it reports
        }
}

TEST_CASE("the comparison of neighbourhoods sees one misplaced site") {
    auto sites = granular::lattice_sites(fit_lattice(3.0, 97, 0.0), 3.0);
    sites[40].x() += 1e-6;
    CHECK(unevenness(sites, 3.0) > 1e-7);
}

TEST_CASE("nonsense is refused") {
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        CHECK_THROWS_AS(fit_lattice(bad, 10, 0.0), InputError);
    CHECK_THROWS_AS(fit_lattice(1.0, 0, 0.0), InputError);
    CHECK_THROWS_AS(fit_lattice(1.0, 10, std::numeric_limits<double>::infinity()), InputError);
}
