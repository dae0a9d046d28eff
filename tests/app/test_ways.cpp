// Which way to compute a bed, a fit or a field map is worth having: bias told apart from scatter.

#include "rodwake/app/tradeoff.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::app;

namespace {

Way way(std::string key, double seconds, double bias, double bias_error, double scatter) {
    Way one{{std::move(key)}, seconds, 10};
    one.found.push_back(
        {"speed", "m/s", 2.0 + bias, scatter / std::sqrt(10.0), scatter, bias, bias_error, 2.0});
    return one;
}

Tradeoff two_ways() {
    Tradeoff ways;
    ways.ways = {way("slow=1", 8.0, 0.0, 0.01, 0.2), way("fast=1", 1.0, 0.05, 0.03, 0.2)};
    return ways;
}

} // namespace

TEST_CASE("a bias counts as far as it exceeds its error, and runs make up for the scatter") {
    const Tradeoff ways = two_ways();
    // b^2 = 0.05^2 - 0.03^2 = 0.04^2; 0.2^2/(0.05^2 - 0.04^2) = 44.4 runs of 1 s, against 16 of 8 s
    const auto rough = cheapest(ways, "speed", 0.05);
    REQUIRE(rough);
    CHECK(rough->way == &ways.ways[1]);
    CHECK(rough->runs == 45);
    CHECK(rough->bias == Approx(0.04));
    CHECK(rough->error() <= 0.05);
    CHECK(rough->seconds() == Approx(45.0));
}

TEST_CASE("an error below the bias of the fast way takes the slow one") {
    const Tradeoff ways = two_ways();
    const auto fine = cheapest(ways, "speed", 0.021);
    REQUIRE(fine);
    CHECK(fine->way == &ways.ways[0]);
    CHECK(fine->runs == 91); // (0.2 / 0.021)^2 = 90.7
    CHECK_FALSE(cheapest(ways, "speed", 0.0));
}

TEST_CASE("within a time the best mixture of bias and scatter is taken") {
    const Tradeoff ways = two_ways();
    CHECK(most_accurate(ways, "speed", 8.5)->way == &ways.ways[1]); // 1 slow run: 0.2; 8 fast: 0.081
    CHECK(most_accurate(ways, "speed", 1000.0)->way == &ways.ways[0]);
    CHECK(most_accurate(ways, "speed", 1000.0)->runs == 125);
    CHECK_FALSE(most_accurate(ways, "speed", 0.5));
}

TEST_CASE("without scatter one run is enough, and an error of zero may be met") {
    Tradeoff ways;
    ways.ways = {way("exact=1", 3.0, 0.0, 0.0, 0.0), way("table=1", 1.0, 1e-6, 0.0, 0.0)};
    CHECK(cheapest(ways, "speed", 0.0)->way == &ways.ways[0]);
    CHECK(cheapest(ways, "speed", 1e-6)->way == &ways.ways[1]);
    CHECK(cheapest(ways, "speed", 1e-6)->runs == 1);
    CHECK(most_accurate(ways, "speed", 1e9)->runs == 1);
}

TEST_CASE("ways without a result are never chosen, and unknown quantities are named") {
    Tradeoff ways = two_ways();
    ways.ways[1].status = "the step is too long";
    CHECK(cheapest(ways, "speed", 0.05)->way == &ways.ways[0]);
    CHECK_FALSE(cheapest(ways, "heat", 1.0));
    CHECK_THROWS_WITH(reference_of(ways, "heat"), "\"heat\" is not measured of this bed; there is speed");
    ways.ways.front().status = "failed";
    ways.ways.front().found.clear();
    ways.ways[1].found.clear();
    CHECK_THROWS_WITH(reference_of(ways, "speed"), "no way to compute the bed gave a result: failed");
}
