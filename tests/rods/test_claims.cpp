// What the paper says of trajectories, and what solving adds to it (studies/reports/rods.md).

#include "rodwake/core/error.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace rodwake;
using rodwake::Ending;

namespace {

constexpr double quarter_turn = 0.5 * std::numbers::pi;

/// Rod 0 from the origin along +x, rod 1 from (dx, -5) along +y.
rods::RodProblem perpendicular(double alpha, double dx, rods::Couplings couplings, double t_end) {
    return {elastic::Medium{1.0, 1.0 / alpha},
            couplings,
            {{0.0, 0.0, 0.0}, {dx, -5.0, quarter_turn}},
            t_end,
            {},
            0.02};
}

rods::RodProblem side_by_side(double alpha, double kappa, double t_end) {
    return {elastic::Medium{1.0, 1.0 / alpha},
            {.kappa = kappa},
            {{0.0, 2.5, 0.0}, {0.0, -2.5, 0.0}},
            t_end,
            {},
            0.1};
}

} // namespace

TEST_CASE("side-by-side rods 5 apart attract at kappa = 0.5") {
    const auto result = rods::simulate(side_by_side(1.0, 0.5, 60.0), {});
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.time ==
          Approx(40.5953).margin(1e-3)); // reference to 6 digits, default tolerance 1e-8
    CHECK(result.outcome.turn[0] < 0.0);
    CHECK(result.outcome.turn[1] > 0.0);
}

TEST_CASE("screening at alpha = 10 keeps side-by-side rods apart") {
    CHECK(rods::simulate(side_by_side(10.0, 0.5, 200.0), {}).outcome.ending != Ending::contact);
}

TEST_CASE("perpendicular starts with kappa = 100 end in contact or pursuit") {
    const auto alpha = GENERATE(1.0, 10.0);
    for (double dx = -6.0; dx <= 6.0; dx += 0.5) {
        const auto outcome = rods::simulate(perpendicular(alpha, dx, {.kappa = 100.0}, 40.0), {}).outcome;
        INFO("alpha " << alpha << " dx " << dx << ": " << outcome.reason);
        CHECK((outcome.ending == Ending::contact || outcome.ending == Ending::pursuit));
    }
}

TEST_CASE("kappa = -100 does not capture, near-collision courses aside") {
    // At the paper's alpha = 10 only starts near dx = 5, where both reach the crossing at once, meet.
    for (double dx = -6.0; dx <= 6.0; dx += 0.5) {
        if (std::abs(dx - 5.0) < 0.75)
            continue;
        const auto outcome = rods::simulate(perpendicular(10.0, dx, {.kappa = -100.0}, 60.0), {}).outcome;
        INFO("dx " << dx << ": " << outcome.reason);
        CHECK(outcome.ending == Ending::escape);
    }
}

TEST_CASE("what meets at kappa = -100 meets exactly head-on, also at alpha = 1") {
    int met = 0;
    for (double dx = -6.0; dx <= 6.0; dx += 0.5) {
        const auto result = rods::simulate(perpendicular(1.0, dx, {.kappa = -100.0}, 400.0), {});
        INFO("dx " << dx << ": " << result.outcome.reason);
        CHECK(result.outcome.ending != Ending::pursuit);
        if (result.outcome.ending != Ending::contact)
            continue;
        ++met;
        const auto& y = result.solution.final_state;
        CHECK(std::abs(y[5] - y[2]) ==
              Approx(std::numbers::pi).margin(1e-6)); // the torque at 0.02 locks it to 1e-12
    }
    CHECK(met == 12); // dx = 0.5 to 6: docs/theory.md, section 5, item 7
}

TEST_CASE("polar couplings alone do not capture, but (10, -10) does for dx >= 4") {
    const auto signs = GENERATE(table<double, double>({{10, 10}, {10, -10}, {-10, 10}, {-10, -10}}));
    const auto [gamma1, gamma2] = signs;
    for (double dx = -6.0; dx <= 6.0; dx += 1.0) {
        const bool near_collision = dx == 5.0; // both reach the crossing at once
        const rods::Couplings polar{.gamma1 = gamma1, .gamma2 = gamma2};
        const auto outcome = rods::simulate(perpendicular(10.0, dx, polar, 100.0), {}).outcome;
        INFO("gamma " << gamma1 << ", " << gamma2 << ", dx " << dx << ": " << outcome.reason);
        if (gamma1 > 0.0 && gamma2 < 0.0 && dx >= 4.0)
            CHECK(outcome.ending == Ending::contact); // the paper: no capture in all cases
        else if (!near_collision)
            CHECK(outcome.ending == Ending::escape);
    }
}

TEST_CASE("in a pursuit at alpha = 10 the front rod turns by less than 1e-3 of what the rear one does") {
    const auto result = rods::simulate(perpendicular(10.0, 1.0, {.kappa = 100.0}, 16.0), {});
    REQUIRE(result.outcome.ending == Ending::pursuit);
    const double front = std::abs(result.outcome.turn[0]), rear = std::abs(result.outcome.turn[1]);
    CAPTURE(front, rear, front / rear);
    CHECK(rear > 1.0);
    CHECK(front < 1e-3 * rear);
}
