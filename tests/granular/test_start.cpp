// Starts: nothing overlaps (looked at pair by pair), the right numbers, and the same state for the same seed.

#include "rodwake/core/error.hpp"
#include "rodwake/granular/start.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

using namespace rodwake;
using granular::GranularProblem;
using granular::make_start;
using granular::restart_from;
using granular::Start;
using granular::State;

namespace {

constexpr double a = 0.4e-3;

GranularProblem bed(double phi, Start start, double box_in_a = 78.0) {
    GranularProblem problem;
    problem.box = box_in_a * a;
    problem.beads = static_cast<std::size_t>(std::lround(phi * box_in_a * box_in_a / M_PI));
    problem.start = start;
    return problem;
}

void add_rod(GranularProblem& problem, double x, double y, double heading) {
    granular::RodSpec rod;
    rod.position = {x * a, y * a};
    rod.heading = heading;
    problem.rods.push_back(rod);
}

double floor_height(const GranularProblem& problem) {
    const double omega = 2.0 * M_PI * problem.plates.frequency,
                 amplitude = problem.plates.gamma * 9.81 / (omega * omega);
    return amplitude * std::cos(omega * static_cast<double>(problem.equilibration_steps) * problem.time_step);
}

/// Between two coordinates in [0, box).
double nearest(double u, double v, double box) { return std::min(std::abs(u - v), box - std::abs(u - v)); }

double into_box(double u, double box) {
    const double rest = std::fmod(u, box);
    return rest < 0.0 ? rest + box : rest;
}

struct Ball {
    double x, y, z, radius;
    std::size_t body;
};

std::vector<Ball> balls_of(const State& state, const GranularProblem& problem) {
    std::vector<Ball> balls;
    const auto& b = state.beads;
    for (std::size_t i = 0; i < b.size(); ++i)
        balls.push_back({b.x[i], b.y[i], b.z[i], problem.bead_radius, i});
    for (std::size_t k = 0; k < state.rods.size(); ++k) {
        const auto clump = granular::make_clump(problem.rods[k].shape);
        for (std::size_t s = 0; s < clump.offset.size(); ++s) {
            const Eigen::Vector3d centre = state.rods[k].position + clump.offset[s] * state.rods[k].axis();
            balls.push_back({centre.x(), centre.y(), centre.z(), clump.radius[s], b.size() + k});
        }
    }
    return balls;
}

/// Smallest free distance of any two bodies that are less than 2 mm apart in x, or of a body and a plate, m;
/// negative: an overlap. Every pair is looked at.
double clearance(const State& state, const GranularProblem& problem) {
    auto balls = balls_of(state, problem);
    const double floor = floor_height(problem), lid = floor + problem.plates.gap, box = problem.box;
    for (Ball& ball : balls) {
        ball.x = into_box(ball.x, box);
        ball.y = into_box(ball.y, box);
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < balls.size(); ++i) {
        const Ball& p = balls[i];
        least = std::min({least, p.z - p.radius - floor, lid - p.z - p.radius});
        for (std::size_t j = i + 1; j < balls.size(); ++j) {
            const Ball& q = balls[j];
            const double x = nearest(p.x, q.x, box);
            if (x < 2e-3 && p.body != q.body) // more than any two radii together
                least =
                    std::min(least, std::hypot(x, nearest(p.y, q.y, box), p.z - q.z) - p.radius - q.radius);
        }
    }
    return least;
}

void check_start(const GranularProblem& problem, std::uint32_t run = 0) {
    INFO(problem.beads << " beads, " << problem.rods.size() << " rods, orientation " << problem.orientation);
    const State state = make_start(problem, run);
    REQUIRE(state.beads.size() == problem.beads);
    REQUIRE(state.rods.size() == problem.rods.size());
    CHECK(clearance(state, problem) > 0.0);
    for (std::size_t i = 0; i < problem.beads; ++i)
        REQUIRE((state.beads.x[i] >= 0.0 && state.beads.x[i] < problem.box && state.beads.y[i] >= 0.0 &&
                 state.beads.y[i] < problem.box));
}

double mean(const std::vector<double>& numbers, int power) {
    double sum = 0.0;
    for (const double number : numbers)
        sum += std::pow(number, power);
    return sum / static_cast<double>(numbers.size());
}

/// A bed as an earlier run may have left it: beads many boxes away, each marked by its spin, and other rods.
State left_behind(const GranularProblem& problem) {
    State stored = make_start(problem, 7);
    stored.step = 1000;
    stored.rods.resize(3);
    for (std::size_t i = 0; i < stored.beads.size(); ++i) {
        stored.beads.x[i] += problem.box * static_cast<double>(i % 7) - 3.0 * problem.box;
        stored.beads.y[i] -= problem.box * static_cast<double>(i % 3);
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
    state.beads.x[3] = state.beads.x[0] + 1.999 * a + 5 * problem.box; // an image
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
    std::string words;
    try {
        make_start(full, 0);
    } catch (const RunError& error) {
        words = error.what();
    }
    CHECK_THAT(words, Catch::Contains("phi_b = 0.9") && Catch::Contains("bead radii") &&
                          Catch::Contains("start = \"lattice\""));
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
    const Clump clump = make_clump({});
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
        REQUIRE(nearest(state.beads.x[i], into_box(stored.beads.x[from], problem.box), problem.box) < 1e-16);
        REQUIRE(nearest(state.beads.y[i], into_box(stored.beads.y[from], problem.box), problem.box) < 1e-16);
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
            const double x =
                nearest(into_box(ball.x, problem.box), into_box(stored.beads.x[i], problem.box), problem.box);
            const double y =
                nearest(into_box(ball.y, problem.box), into_box(stored.beads.y[i], problem.box), problem.box);
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
    smaller.box *= 0.885; // beads in disorder cover 0.7/0.783 = 0.894 of it: only a crystal would fit
    smaller.plates.gap = 2.001 * a;
    CHECK_THROWS_WITH(restart_from(smaller, stored, 0), Catch::Contains("same size"));
    CHECK_THROWS_AS(restart_from(smaller, stored, 0), RunError);
    GranularProblem lone;
    add_rod(lone, 20, 20, 0.0);
    CHECK(restart_from(lone, stored, 0).rods.size() == 1);
}

TEST_CASE("a hundred thousand beads start at random", "[.][long]") {
    auto problem = bed(0.8, Start::random, 626.0);
    add_rod(problem, 300, 300, 0.5);
    REQUIRE(problem.beads > 99'000);
    check_start(problem);
}
