// The three forms of the nearest image against each other, and their domains.

#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;

namespace {

constexpr double box = 0.0312;

/// By trying all images up to two boxes away.
double by_trying(double difference, double side) {
    double best = difference;
    for (int n = -3; n <= 3; ++n)
        if (const double image = difference - n * side; std::abs(image) < std::abs(best))
            best = image;
    return best;
}

} // namespace

TEST_CASE("the forms of the nearest image agree where each may be used") {
    RandomStream random(81);
    for (int i = 0; i < 20000; ++i) {
        const double d = random.uniform(-1.5 * box, 1.5 * box), wanted = by_trying(d, box);
        const double rounding = 1e-15 * box; // of a difference of 1.5 boxes: 2^-52 of it
        REQUIRE(std::abs(nearest_image_once(d, box) - wanted) <= rounding);
        REQUIRE(std::abs(nearest_image_rounded(d, box) - wanted) <= rounding);
        REQUIRE(std::abs(nearest_image(d, box) - wanted) <= rounding);
        REQUIRE(std::abs(d - nearest_shift(d, box) - wanted) <= rounding);
    }
}

TEST_CASE("differences of two places in the box have the same bits in both inline forms") {
    RandomStream random(82);
    for (int i = 0; i < 20000; ++i) {
        const double d = random.uniform(0.0, box) - random.uniform(0.0, box);
        REQUIRE(nearest_image_once(d, box) == nearest_image_rounded(d, box));
    }
}

TEST_CASE("far differences are for the general forms") {
    const double far = 1000.25; // boxes
    CHECK(nearest_image(far, 1.0) == 0.25);
    CHECK(nearest_image_rounded(far, 1.0) == 0.25);
    CHECK(nearest_image_rounded(-far, 1.0) == -0.25);
    CHECK(nearest_image_once(far, 1.0) == 999.25); // outside its domain
    CHECK(nearest_shift(far, 1.0) == 1000.0);
    CHECK(nearest_image(0x1p60 + 0x1p8, 1.0) == 0.0);
}

TEST_CASE("whole numbers, half to even") {
    for (const auto& [x, wanted] : {std::pair{0.5, 0.0},
                                    {1.5, 2.0},
                                    {2.5, 2.0},
                                    {-0.5, 0.0},
                                    {-1.5, -2.0},
                                    {0.49999999999999994, 0.0},
                                    {1e15 + 0.5, 1e15},
                                    {7.3, 7.0}}) {
        CHECK(nearest_whole(x) == wanted);
        CHECK(nearest_whole(x) == std::nearbyint(x));
    }
}

TEST_CASE("places are put back into the box, never onto its upper edge") {
    CHECK(into_box(0.3, 1.0) == 0.3); // to the bit: what is inside stays
    CHECK(into_box(-0.25, 1.0) == 0.75);
    CHECK(into_box(3.75, 1.0) == 0.75);
    CHECK(into_box(1.0, 1.0) == 0.0);
    CHECK(into_box(-1e-20, 1.0) == 0.0); // 1 - 1e-20 is 1 in doubles
    CHECK(nearest_distance(0.7, 0.4, 1.0) == Approx(0.5).epsilon(1e-15));
}
