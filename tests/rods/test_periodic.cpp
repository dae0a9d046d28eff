// Rods in a periodic box: images, contact through the boundary, and the infinite plane as the limit.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/sensitivity.hpp"
#include "rodwake/rods/separation.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace rodwake;
using rods::Couplings;
using rods::Pose;
using rods::RodModel;
using rods::RodProblem;

namespace {

constexpr elastic::Medium medium{.eta = 1.0, .xi = 1.0};
constexpr Couplings all{.kappa = 2.0, .gamma1 = 0.5, .gamma2 = -0.3};

std::vector<double> rates(const std::vector<Pose>& poses, std::optional<double> box,
                          const Couplings& couplings = all, elastic::Medium of = medium) {
    const auto y = rods::to_state(poses);
    std::vector<double> ydot(y.size());
    RodModel(elastic::exact_field(of, box), couplings, poses.size()).rhs(y, ydot);
    return ydot;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = a.size() == b.size() ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

rods::RodResult run(const RodProblem& problem, integrate::Method method = integrate::Method::erk) {
    rods::RodOptions options;
    options.ode.method = method;
    options.ode.rtol = 1e-9;
    return rods::simulate(problem, options);
}

RodProblem pair(std::vector<Pose> poses, std::optional<double> box, double t_end, double kappa = 2.0) {
    RodProblem problem;
    problem.medium = medium;
    problem.couplings.kappa = kappa;
    problem.rods = std::move(poses);
    problem.t_end = t_end;
    problem.box = box;
    return problem;
}

} // namespace

TEST_CASE("a rod and its image turn others alike") {
    const std::vector<Pose> near = {{4.9, 0.0, 0.3}, {5.4, 0.5, 2.0}, {0.0, -4.0, -1.0}};
    const std::vector<Pose> wrapped = {{4.9, 0.0, 0.3}, {-4.6, 0.5, 2.0}, {0.0, 16.0, -1.0}};
    CHECK(largest_difference(rates(near, 10.0), rates(wrapped, 10.0)) < 1e-11); // rounding of 5.4 - 10
    CHECK(largest_difference(rates(near, {}), rates(wrapped, {})) > 0.1);       // no images on the plane
    CHECK(largest_difference(rates(near, 10.0), rates(wrapped, 10.5)) > 1e-3);
}

TEST_CASE("a quarter turn of the box changes no turning") {
    const std::vector<Pose> poses = {{1.0, 0.5, 0.3}, {-1.5, 2.0, 2.0}};
    std::vector<Pose> turned;
    for (const Pose& p : poses)
        turned.push_back({-p.y, p.x, p.heading + std::numbers::pi / 2});
    const auto a = rates(poses, 7.0), b = rates(turned, 7.0);
    CHECK(a[2] == Approx(b[2]).epsilon(1e-11));
    CHECK(a[5] == Approx(b[5]).epsilon(1e-11));
}

TEST_CASE("a rod turns in its own images' wakes, but not along the box's axes and diagonals") {
    for (const double heading : {0.0, std::numbers::pi / 4, std::numbers::pi / 2, -std::numbers::pi})
        CHECK(std::abs(rates({{1.0, 2.0, heading}}, 3.0)[2]) < 1e-12);
    const double turning = rates({{1.0, 2.0, 0.3}}, 3.0)[2];
    CHECK(std::abs(turning) > 1e-4);
    CHECK(rates({{1.0, 2.0, -0.3}}, 3.0)[2] == Approx(-turning)); // mirrored
    CHECK(rates({{1.0, 2.0, 0.3}}, {})[2] == 0.0);
    // The torque is kappa eps_xy of the images: of a neighbour so near that the images are the same for both,
    // what it turns another beyond the plane's torque is what it turns itself.
    const Couplings kappa{.kappa = 2.0};
    const double own = rates({{0.0, 0.0, 0.3}}, 3.0, kappa)[2];
    const std::vector<Pose> close = {{0.0, 0.0, 0.3}, {1e-4, 0.0, 0.3}};
    CHECK(rates(close, 3.0, kappa)[2] - rates(close, {}, kappa)[2] == Approx(2.0 * own).epsilon(1e-2));
}

TEST_CASE("in a large box rods move as on the plane") {
    const std::vector<Pose> side = {{0.0, 2.5, 0.0}, {0.0, -2.5, 0.0}};
    const Couplings kappa{.kappa = 2.0};
    const auto rate = [&](double box) { return rates(side, box, kappa)[2] - rates(side, {}, kappa)[2]; };
    // Only the wakes of images ahead are left: beside a wake's axis its strain falls as L^(-3/2).
    CHECK(rate(1000.0) / rate(4000.0) ==
          Approx(8.0).epsilon(0.1)); // it ends where wakes fill the box: sqrt(xi/L)
    CHECK(std::abs(rate(1000.0)) < 1e-2 * std::abs(rates(side, {}, kappa)[2]));

    const auto on_plane = run(pair(side, {}, 8.0));
    const auto difference = [&](double box) {
        return largest_difference(on_plane.solution.final_state,
                                  run(pair(side, box, 8.0)).solution.final_state);
    };
    CHECK(std::abs(on_plane.outcome.turn[0]) > 0.05);
    CHECK(difference(1200.0) < 1e-3); // rods that turned are in their own images' wakes, which fall slower
    CHECK(difference(12.0) > 2e-2);
}

TEST_CASE("a mirror pair in a box stays one, by every method") {
    const auto problem = pair({{0.0, 2.0, 0.1}, {0.0, -2.0, -0.1}}, 9.0, 6.0);
    const auto result = run(problem);
    const auto& y = result.solution.final_state;
    REQUIRE(result.solution.status.ok());
    CHECK(y[0] == Approx(y[3]).epsilon(1e-8));
    CHECK(y[1] == Approx(-y[4]).epsilon(1e-8));
    CHECK(y[2] == Approx(-y[5]).epsilon(1e-8));
    CHECK(std::abs(y[2] - 0.1) > 0.01);
    const auto bdf = run(problem, integrate::Method::bdf);
    REQUIRE(bdf.solution.status.ok());
    CHECK(largest_difference(bdf.solution.final_state, y) < 1e-6); // rtol 1e-9 for either
    CHECK(rods::stiffness(problem) < 30.0);
}

TEST_CASE("rods meet through the boundary") {
    auto head_on = pair({{-4.5, 0.0, std::numbers::pi}, {4.5, 0.0, 0.0}}, 10.0, 2.0);
    head_on.contact_distance = 0.1;
    const auto met = run(head_on);
    CHECK(met.outcome.ending == Ending::contact);
    CHECK(met.outcome.time == Approx(0.45).epsilon(1e-6)); // (1 - 0.1)/2: head on nothing turns
    CHECK(met.outcome.pair.distance == Approx(0.1).epsilon(1e-6));
    CHECK(met.solution.final_state[3] == Approx(4.95)); // positions go on past the boundary
    head_on.box.reset();
    CHECK(run(head_on).outcome.ending != Ending::contact);
    head_on.box = 10.0;
    head_on.contact_distance = 1.5; // the starting separation is 1
    CHECK(run(head_on).outcome.time == 0.0);
    CHECK(run(head_on).outcome.min_separation == Approx(1.0).epsilon(1e-14)); // of places of order 10
    auto same = pair({{-5.0, 0.0, 0.0}, {5.0, 0.0, 1.0}}, 10.0, 1.0);
    CHECK_THROWS_WITH(run(same), Catch::Contains("same place"));
}

TEST_CASE("an approach within a step is seen through the boundary") {
    // Abreast of each other, 0.2 apart, at u = 1/2; at the step's end the nearest image is another one.
    const std::vector<double> before = {4.5, 0.0, 0.0, -4.5, 0.2, std::numbers::pi},
                              after = {5.5, 0.0, 0.0, -5.5, 0.2, std::numbers::pi};
    const integrate::Step step{.time_before = 0.0, .time = 1.0, .state_before = before, .state = after};
    const auto seen = rods::closest_approach(step, 10.0);
    REQUIRE(seen);
    CHECK(seen->time == Approx(0.5));
    CHECK(seen->pair.distance == Approx(0.2));
    CHECK_FALSE(rods::closest_approach(step));
    CHECK(rods::closest_pair(before, 10.0).distance == Approx(std::hypot(1.0, 0.2)));
    CHECK(rods::encounter_step(before, 10.0) < 0.2);
    CHECK(rods::encounter_step(before) > 1.0);
}

TEST_CASE("rods that part in the plane but approach each other's images have not escaped") {
    const std::vector<double> y = {4.5, 0.0, 0.0, -4.5, 0.2, std::numbers::pi}, ydot = {1, 0, 0, -1, 0, 0};
    const TailWindow late{1.0, 9.0, 0.0};
    CHECK(rods::classify_pair(y, ydot, 0, 1, late) == Ending::escape);
    CHECK(rods::classify_pair(y, ydot, 0, 1, late, {}, 10.0) == Ending::undecided);
}

TEST_CASE("what a periodic box does not offer is said") {
    for (const double box : {0.0, -2.0, std::nan("")})
        CHECK_THROWS_WITH(run(pair({{0, 0, 0}, {1, 1, 0}}, box, 1.0)), Catch::Contains("box ="));
    CHECK(RodModel(elastic::exact_field(medium, 5.0), all, 1).interacting());
    const auto alone = run(pair({{0, 0, 0.3}}, 3.0, 1.0));
    CHECK(alone.solution.status.ok());
    CHECK(alone.outcome.turn[0] != 0.0);
}

// --- Rods in a periodic rectangle: images by each side its own, and the square that a doubled rectangle is

namespace {

RodProblem problem_in(const PeriodicBox& box, std::vector<Pose> poses, double t_end) {
    RodProblem problem;
    problem.medium = elastic::Medium{.eta = 1.0, .xi = 1.0};
    problem.couplings = {.kappa = 2.0, .gamma1 = 0.5, .gamma2 = -0.3};
    problem.rods = std::move(poses);
    problem.t_end = t_end;
    problem.box = box;
    return problem;
}

} // namespace

TEST_CASE("two rods in a square and their doubles in a rectangle of two squares walk alike") {
    const std::vector<Pose> square = {{0.0, 1.0, 0.1}, {0.5, -1.5, 0.6}};
    for (const bool along_y : {true, false}) {
        std::vector<Pose> doubled = square;
        for (const Pose& rod : square)
            doubled.push_back({rod.x + (along_y ? 0.0 : 6.0), rod.y + (along_y ? 6.0 : 0.0), rod.heading});
        const auto one = run(problem_in(6.0, square, 5.0)),
                   two = run(
                       problem_in(along_y ? PeriodicBox{6.0, 12.0} : PeriodicBox{12.0, 6.0}, doubled, 5.0)),
                   other = run(
                       problem_in(along_y ? PeriodicBox{6.0, 12.0} : PeriodicBox{12.0, 6.0}, square, 5.0));
        REQUIRE(one.solution.status.ok());
        REQUIRE(two.solution.status.ok());
        const auto &y = one.solution.final_state, &z = two.solution.final_state;
        CAPTURE(along_y);
        for (std::size_t k = 0; k < y.size(); ++k)
            CHECK(z[k] == Approx(y[k]).margin(1e-6));                 // rtol 1e-9 over some turns
        CHECK(std::abs(other.solution.final_state[2] - y[2]) > 1e-3); // without the doubles
    }
}

TEST_CASE("rods meet through each side of a rectangle where that side is") {
    constexpr PeriodicBox box{10.0, 16.0};
    auto problem = problem_in(box, {{0.0, -7.5, -std::acos(0.0)}, {0.0, 7.5, std::acos(0.0)}}, 2.0);
    problem.contact_distance = 0.1;
    const auto met = run(problem);
    CHECK(met.outcome.ending == Ending::contact);
    CHECK(met.outcome.time == Approx(0.45).epsilon(1e-6)); // (1 - 0.1)/2: head on nothing turns
    const std::vector<double> y = {-4.5, 0.0, 0.0, 4.5, 7.0, 0.0};
    CHECK(rods::offset(y, 0, 1, box).x == Approx(1.0));
    CHECK(rods::offset(y, 0, 1, box).y == Approx(-7.0));
    CHECK(rods::offset(y, 0, 1, PeriodicBox{16.0, 10.0}).x == Approx(7.0));
    CHECK(rods::offset(y, 0, 1, PeriodicBox{16.0, 10.0}).y == Approx(3.0));
}

TEST_CASE("the closest pair of many rods in a rectangle is found whichever way they are spread") {
    RandomStream random(31);
    for (int k = 0; k < 40; ++k) {
        const PeriodicBox box = k % 2 ? PeriodicBox{8.0, 30.0} : PeriodicBox{30.0, 8.0};
        std::vector<double> y(3 * 60);
        for (std::size_t i = 0; i < y.size(); ++i)
            y[i] = random.uniform(-40.0, 40.0);
        double nearest = 1e300;
        for (std::size_t a = 0; a < 60; ++a)
            for (std::size_t b = a + 1; b < 60; ++b)
                nearest = std::min(nearest,
                                   nearest_distance(y[3 * a] - y[3 * b], y[3 * a + 1] - y[3 * b + 1], box));
        CAPTURE(k);
        CHECK(rods::closest_pair(y, box).distance == Approx(nearest).epsilon(1e-12));
    }
}

TEST_CASE("a rectangle without two sides is refused") {
    for (const PeriodicBox& box : {PeriodicBox{5.0, 0.0}, {-5.0, 5.0}, {5.0, std::nan("")}})
        CHECK_THROWS_WITH(run(problem_in(box, {{0, 0, 0}, {1, 1, 0}}, 1.0)), Catch::Contains("box ="));
}
