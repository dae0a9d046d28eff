// How an encounter ends, and the frame a pair's separation is measured in.

#include "rodwake/core/encounter.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace rodwake;

namespace {

constexpr double pi = std::numbers::pi;

/// Rods at unit speed, `turning` both, the separation between low and high lately.
PairEnd end_of(double x, double y, double heading0, double heading1, double turning, double low,
               double high) {
    PairEnd end;
    end.x = x;
    end.y = y;
    end.heading[0] = heading0;
    end.heading[1] = heading1;
    end.vx = std::cos(heading0) - std::cos(heading1);
    end.vy = std::sin(heading0) - std::sin(heading1);
    end.angle = angle_between(heading0, heading1);
    end.late = {low, high, turning};
    return end;
}

} // namespace

TEST_CASE("each limit of an ending counts", "[encounter]") {
    const EndingCriteria exact;
    CHECK(classify(end_of(3, 0, 0, 0.05, 0, 2.9, 3), exact) == Ending::pursuit);
    CHECK(classify(end_of(-3, 0, 0, 0.05, 0, 2.9, 3), exact) == Ending::pursuit);     // either in front
    CHECK(classify(end_of(3, 0, 0.05, 2 * pi, 0, 2.9, 3), exact) == Ending::pursuit); // modulo a turn
    CHECK(classify(end_of(3, 0, 0, 0.11, 0.1, 2.9, 3), exact) == Ending::undecided);  // headings
    CHECK(classify(end_of(3, 0.7, 0, 0, 0, 2.9, 3), exact) == Ending::undecided);     // beside
    CHECK(classify(end_of(3, 0, 0, 0, 0, 2.7, 3), exact) == Ending::undecided);       // not steady
    CHECK(classify(end_of(3, 0, 0, pi, 0.1, 1, 3), exact) == Ending::escape);
    CHECK(classify(end_of(3, 0, 0, pi, 0.11, 1, 3), exact) == Ending::undecided); // 0.165 rad in 1.5, of pi
    CHECK(classify(end_of(0, -3, 0, 1e-3, 1.6e-8, 1, 3), exact) == Ending::escape);
    CHECK(classify(end_of(0, -3, 0, 1e-3, 1.7e-8, 1, 3), exact) ==
          Ending::undecided);                                                   // 5.1e-5 in 3000, of 1e-3
    CHECK(classify(end_of(-3, 0, 0, pi, 0, 1, 3), exact) == Ending::undecided); // approaching
    CHECK(classify(end_of(0, 3, 0, 0, 0, 3, 3), exact) == Ending::undecided);   // abreast for ever
}

TEST_CASE("a noisy track has the same endings with wider limits", "[encounter]") {
    CHECK(classify(end_of(3, 0.7, 0, 0.3, 0.1, 2.1, 3), noisy_track) == Ending::pursuit);
    CHECK(classify(end_of(3, 0, 0, pi, 1.0, 1, 3), noisy_track) == Ending::escape);
    CHECK(classify(end_of(3, 0, 0, pi, 1.1, 1, 3), noisy_track) == Ending::undecided);
    CHECK(classify(end_of(3, 3.1, 0, 0, 0, 4.3, 4.3), noisy_track) == Ending::undecided); // rather beside
    for (const double EndingCriteria::*limit :
         {&EndingCriteria::locked_heading, &EndingCriteria::lateral_offset,
          &EndingCriteria::steady_separation, &EndingCriteria::steady_fraction,
          &EndingCriteria::residual_turn})
        CHECK(noisy_track.*limit > EndingCriteria{}.*limit);
}

TEST_CASE("units of length and time do not matter to an ending", "[encounter]") {
    for (const auto& criteria : {EndingCriteria{}, noisy_track})
        for (const double heading : {0.0, 0.04, 0.3, 1.0, pi}) {
            PairEnd end = end_of(3, 0.5, 0, heading, 0.02, 2.8, 3.05);
            const Ending before = classify(end, criteria);
            const double length = 4e-4, time = 0.3;
            for (double* value : {&end.x, &end.y, &end.late.min_separation, &end.late.max_separation})
                *value *= length;
            for (double* value : {&end.vx, &end.vy})
                *value *= length / time;
            end.late.max_turning /= time;
            CHECK(classify(end, criteria) == before);
        }
}

TEST_CASE("endings have the names that outcome.json writes", "[encounter]") {
    CHECK(to_string(Ending::contact) == "contact");
    CHECK(to_string(Ending::pursuit) == "pursuit");
    CHECK(to_string(Ending::escape) == "escape");
    CHECK(to_string(Ending::undecided) == "undecided");
}

TEST_CASE("a pair's course: along and across the mean first heading, outwards positive", "[encounter]") {
    for (const double turn : {0.0, 0.3, -2.0}) {
        const double c = std::cos(turn), s = std::sin(turn);
        for (const double side : {1.0, -1.0}) {
            const double y = side * 5.0;
            const PairFrame course(turn + 0.2, turn - 0.2, 2.0 * c - y * s, 2.0 * s + y * c);
            REQUIRE(course.common());
            CHECK(course.separation() == Approx(5.0).epsilon(1e-14)); // rounding of a few products
            CHECK(course.ahead(c, s) == Approx(1.0).epsilon(1e-14));
            CHECK(course.across(-s, c) == Approx(1.0).epsilon(1e-14));
            CHECK(course.change(-s, c) == Approx(side).epsilon(1e-14));
            CHECK(course.change(c, s) == Approx(0.0).margin(1e-14));
        }
    }
    CHECK_FALSE(PairFrame(0.0, pi, 1.0, 0.0).common());
}
