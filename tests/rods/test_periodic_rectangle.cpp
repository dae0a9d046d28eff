// Rods in a periodic rectangle: images by each side its own, and the square that a doubled rectangle is.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/sensitivity.hpp"
#include "rodwake/rods/separation.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace rodwake;
using rods::Pose;
using rods::RodProblem;

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

rods::RodResult run(const RodProblem& problem) {
    rods::RodOptions options;
    options.ode.method = integrate::Method::erk;
    options.ode.rtol = 1e-9;
    return rods::simulate(problem, options);
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
