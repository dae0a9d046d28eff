// Starts from the bed of an earlier run.

#include "rodwake/core/error.hpp"
#include "starts.hpp"

#include <set>

using namespace starts;
using granular::restart_from;

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
