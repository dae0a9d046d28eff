// Order of many rods on configurations whose order is known, clusters against looking at all pairs.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/measure/rod_order.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

constexpr double pi = std::numbers::pi;

std::vector<RodPosition> random_places(std::size_t rods, double side, std::uint64_t seed) {
    RandomStream random(seed);
    std::vector<RodPosition> places;
    for (std::size_t a = 0; a < rods; ++a) {
        const double x = random.uniform(-side, 2.0 * side), y = random.uniform(0.0, side);
        places.push_back({x, y, random.uniform(-pi, pi)});
    }
    return places;
}

/// By spreading a label until nothing changes.
std::vector<std::size_t> sizes_of_all(const std::vector<RodPosition>& rods, double link,
                                      std::optional<double> box) {
    std::vector<std::size_t> label(rods.size());
    std::iota(label.begin(), label.end(), std::size_t{0});
    const auto linked = [&](const RodPosition& a, const RodPosition& b) {
        return (box ? nearest_distance(a.x - b.x, a.y - b.y, *box) : std::hypot(a.x - b.x, a.y - b.y)) < link;
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t a = 0; a < rods.size(); ++a)
            for (std::size_t b = 0; b < rods.size(); ++b)
                if (label[b] < label[a] && linked(rods[a], rods[b])) {
                    label[a] = label[b];
                    changed = true;
                }
    }
    std::vector<std::size_t> sizes;
    for (std::size_t k = 0; k < rods.size(); ++k)
        if (const auto count = std::ranges::count(label, k))
            sizes.push_back(static_cast<std::size_t>(count));
    std::ranges::sort(sizes, std::greater());
    return sizes;
}

} // namespace

TEST_CASE("order of headings that are known") {
    std::vector<RodPosition> rods;
    for (int k = 0; k < 12; ++k)
        rods.push_back({10.0 * k, 0.0, 0.3});
    CHECK(rod_order(rods, 1.0).polar == Approx(1.0).epsilon(1e-14));
    CHECK(rod_order(rods, 1.0).nematic == Approx(1.0).epsilon(1e-14));
    for (std::size_t k = 0; k < 12; k += 2)
        rods[k].heading += pi; // to and fro
    CHECK(rod_order(rods, 1.0).polar == Approx(0.0).margin(1e-14));
    CHECK(rod_order(rods, 1.0).nematic == Approx(1.0).epsilon(1e-14));
    for (std::size_t k = 0; k < 12; ++k)
        rods[k].heading = 2.0 * pi * static_cast<double>(k) / 12.0;
    CHECK(rod_order(rods, 1.0).polar == Approx(0.0).margin(1e-14));
    CHECK(rod_order(rods, 1.0).nematic == Approx(0.0).margin(1e-14));
    // an even fan of half width s: the sinc of s and of 2 s, to 1/N^2
    const double s = 0.7;
    rods.assign(2000, {});
    for (std::size_t k = 0; k < rods.size(); ++k)
        rods[k] = {5.0 * static_cast<double>(k), 0.0,
                   s * (2.0 * (static_cast<double>(k) + 0.5) / 2000.0 - 1.0)};
    CHECK(rod_order(rods, 1.0).polar == Approx(std::sin(s) / s).epsilon(1e-6));
    CHECK(rod_order(rods, 1.0).nematic == Approx(std::sin(2.0 * s) / (2.0 * s)).epsilon(1e-6));
}

TEST_CASE("random headings have the order of their number") {
    double polar = 0.0, nematic = 0.0;
    constexpr int sets = 400;
    constexpr std::size_t rods = 100;
    for (int k = 0; k < sets; ++k) {
        const RodOrder order =
            rod_order(random_places(rods, 1000.0, 100 + static_cast<std::uint64_t>(k)), 0.1);
        polar += order.polar / sets;
        nematic += order.nematic / sets;
    }
    const double expected = std::sqrt(pi / (4.0 * rods)); // of a Rayleigh law, which scatters by 0.52 of it
    const double error = 0.53 * expected / std::sqrt(sets);
    CHECK(std::abs(polar - expected) < 4.0 * error);
    CHECK(std::abs(nematic - expected) < 4.0 * error);
}

TEST_CASE("clusters are those of looking at all pairs") {
    for (const std::size_t rods : {1U, 2U, 7U, 60U, 200U})
        for (const double link : {0.2, 1.0, 3.0, 5.0})
            for (const std::optional<double> box : {std::optional<double>(), std::optional(10.0)}) {
                INFO(rods << " rods, link " << link << ", box " << box.value_or(0.0));
                const auto places = random_places(rods, 10.0, rods);
                const RodOrder order = rod_order(places, link, box);
                CHECK(order.clusters == sizes_of_all(places, link, box));
                CHECK(std::accumulate(order.clusters.begin(), order.clusters.end(), std::size_t{0}) == rods);
            }
}

TEST_CASE("sizes of clusters that are known") {
    // three in a chain, two, one; the ends of the chain are not near each other
    const std::vector<RodPosition> rods{{0, 0, 0}, {0.9, 0, 0}, {1.8, 0, 0},
                                        {9, 9, 0}, {9, 9.5, 0}, {-5, 2, 0}};
    const RodOrder order = rod_order(rods, 1.0);
    CHECK(order.clusters == std::vector<std::size_t>{3, 2, 1});
    CHECK(order.mean_size() == Approx(2.0));
    CHECK(order.weighted_size() == Approx(14.0 / 6.0));
    CHECK(rod_order(rods, 0.9).clusters ==
          std::vector<std::size_t>{2, 1, 1, 1, 1}); // at the link: not nearer
}

TEST_CASE("numbers in cells fluctuate as the places do") {
    // in a box: a lattice that fills all cells alike, and all in one of them, with images
    std::vector<RodPosition> lattice, heap;
    for (int k = 0; k < 64; ++k) {
        lattice.push_back({0.5 + k % 8 - 8.0 * (k % 3), 0.5 + k / 8, 0.0});
        heap.push_back({0.1 + 8.0 * (k % 5), 0.1, 0.0});
    }
    const auto even = number_fluctuations(lattice, 8.0), one = number_fluctuations(heap, 8.0);
    REQUIRE(even.size() == 3); // 2 x 2, 4 x 4, 8 x 8
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(even[k].cell == Approx(4.0 / static_cast<double>(1 << k)));
        CHECK(even[k].rods == Approx(16.0 / static_cast<double>(1 << 2 * k)));
        CHECK(even[k].fluctuation == 0.0);
        CHECK(one[k].fluctuation == Approx(64.0)); // (64^2 - 64^2/M)/((M - 1) 64/M)
    }
    CHECK(number_fluctuations(std::span(heap).first(3), {}).empty());
    CHECK(number_fluctuations(std::vector<RodPosition>(4), {}).front().fluctuation == Approx(4.0));

    // independent places: 1, in the box and on the plane in a square and in a disc
    constexpr int sets = 400;
    std::vector<double> found[3];
    for (int k = 0; k < sets; ++k) {
        RandomStream random(700 + static_cast<std::uint64_t>(k));
        std::vector<RodPosition> square, disc;
        while (square.size() < 200)
            square.push_back({random.uniform(0.0, 10.0), random.uniform(0.0, 10.0), 0.0});
        while (disc.size() < 200) {
            const double x = random.uniform(-1.0, 1.0), y = random.uniform(-1.0, 1.0);
            if (x * x + y * y < 1.0)
                disc.push_back({5.0 + x, y, 0.0});
        }
        found[0].push_back(number_fluctuations(square, 10.0)[1].fluctuation);
        found[1].push_back(number_fluctuations(square, {})[1].fluctuation);
        found[2].push_back(number_fluctuations(disc, {})[1].fluctuation);
    }
    for (const auto& values : found) {
        const Estimate mean = mean_of(values);
        CHECK(std::abs(mean.value - 1.0) < 4.0 * mean.error);
        CHECK(mean.error < 0.03);
    }
}

TEST_CASE("means of a run count from the time on, errors are those of blocks") {
    std::vector<RodOrderSeries> runs(1);
    auto& [times, orders] = runs[0];
    for (int k = 0; k < 40; ++k) {
        times.push_back(k);
        // before 20 something else; then blocks of 5 alternate between 0.4 and 0.6
        const double polar = k < 20 ? 0.9 : k / 5 % 2 ? 0.6 : 0.4;
        orders.push_back({polar,
                          0.5,
                          k % 2 ? std::vector<std::size_t>{2, 1} : std::vector<std::size_t>{3},
                          {},
                          {{4.0, 2.0, polar}}});
    }
    const MeanRodOrder mean = mean_rod_order(runs, 20.0, 5.0);
    CHECK(mean.instants == 20);
    CHECK(mean.blocks == 4);
    CHECK(mean.polar.value == Approx(0.5));
    CHECK(mean.polar.error == Approx(0.1 / std::sqrt(3.0))); // scatter 0.1 of four, s/sqrt(n)
    CHECK(mean.nematic.error == Approx(0.0).margin(1e-15));
    CHECK(mean.clusters == std::vector<double>{0.5, 0.5, 0.5});
    REQUIRE(mean.fluctuations.size() == 1);
    CHECK(mean.fluctuations[0].cell == 4.0);
    CHECK(mean.fluctuations[0].fluctuation == Approx(0.5));
    CHECK(mean.fluctuation_errors[0] == Approx(0.1 / std::sqrt(3.0)));
    CHECK(mean.largest.value == Approx(2.5).margin(0.11));      // blocks of 5 hold 3 of one kind
    CHECK_FALSE(mean_rod_order(runs, 38.0, 5.0).polar.known()); // one block
    CHECK_THROWS_AS(mean_rod_order(runs, 39.5, 5.0), InputError);
}

TEST_CASE("blocks of several runs are values of their own") {
    // runs of 10 instants at 0.2 and 0.8: two blocks of 5 each; a run that ends before `from` has none
    const auto run = [](int instants, double polar) {
        RodOrderSeries series;
        for (int k = 0; k < instants; ++k) {
            series.times.push_back(k);
            series.orders.push_back({polar, 0.5, {1, 1}, {}});
        }
        return series;
    };
    const std::vector<RodOrderSeries> runs{run(12, 0.2), run(2, 9.0), run(12, 0.8)};
    const MeanRodOrder mean = mean_rod_order(runs, 2.0, 5.0);
    CHECK(mean.instants == 20);
    CHECK(mean.blocks == 4);
    CHECK(mean.polar.value == Approx(0.5));
    // four values, two at 0.2 and two at 0.8: s = 0.3 sqrt(4/3) and s/sqrt(4), widened as neighbours are
    // alike
    CHECK(mean.polar.error >= Approx(0.3 / std::sqrt(3.0)));
    CHECK(mean.clusters == std::vector<double>{2.0});
}
