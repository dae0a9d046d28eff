// The first minimum of g(r) on curves whose minimum is known.

#include "order_beds.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::measure;
using order_beds::radius;

namespace {

struct Curve {
    std::vector<double> r, g;
};

/// Nothing below 1.9 a; then 1 + 1.5 cos(k (r - 2.1 a)) exp(-(r - 2.1 a)/(3 a)): a liquid's shells. Its first
/// minimum is where the slope vanishes, tan(k u) = -1/(3 a k).
Curve shells(double bin, double period) {
    Curve c;
    const double k = 2.0 * M_PI / period;
    for (double r = 0.5 * bin; r < 39.0 * radius; r += bin) {
        const double u = r - 2.1 * radius;
        c.r.push_back(r);
        c.g.push_back(r < 1.9 * radius ? 0.0 : 1.0 + 1.5 * std::cos(k * u) * std::exp(-u / (3.0 * radius)));
    }
    return c;
}

double bottom(double period) {
    const double k = 2.0 * M_PI / period;
    return 2.1 * radius + (M_PI - std::atan(1.0 / (3.0 * radius * k))) / k;
}

double normal(RandomStream& random) {
    return std::sqrt(-2.0 * std::log(random.uniform())) * std::cos(2.0 * M_PI * random.uniform());
}

} // namespace

TEST_CASE("the first minimum is found where it is", "[order]") {
    for (const double bin : {0.02, 0.05, 0.1})
        for (const double period : {1.7, 2.0}) {
            const Curve c = shells(bin * radius, period * radius);
            const auto found = first_minimum(c.r, c.g, radius);
            REQUIRE(found.has_value());
            // the curve's cubic term shifts a parabola over 0.3 a by about 0.01 a
            CHECK(std::abs(*found - bottom(period * radius)) < 0.02 * radius);
            CHECK(std::abs(*found - bottom(1.1 * period * radius)) > 0.02 * radius);
        }
}

TEST_CASE("noise moves the first minimum little", "[order]") {
    RandomStream random(21);
    for (int trial = 0; trial < 20; ++trial) {
        Curve c = shells(0.05 * radius, 2.0 * radius);
        for (double& g : c.g)
            g += g > 0.0 ? 0.03 * normal(random) : 0.0;
        const auto found = first_minimum(c.r, c.g, radius);
        REQUIRE(found.has_value());
        // 13 bins, bend 1.5 k^2 e^(-1/3): the vertex scatters by 0.02 a, and the nearest bin by a few
        CHECK(std::abs(*found - bottom(2.0 * radius)) < 0.12 * radius);
    }
}

TEST_CASE("a valley without beads has its minimum in its middle", "[order]") {
    Curve c;
    for (double r = 0.025; r < 10.0; r += 0.05) {
        c.r.push_back(r * radius);
        c.g.push_back((r > 2.0 && r < 2.4) || (r > 3.5 && r < 4.5) ? 5.0 : 0.0);
    }
    const auto found = first_minimum(c.r, c.g, radius);
    REQUIRE(found.has_value());
    CHECK(std::abs(*found - 2.95 * radius) < 0.1 * radius); // the middle of 2.4 a and 3.5 a, two bins
}

TEST_CASE("a curve without a minimum has none", "[order]") {
    for (int trial = 0; trial < 50; ++trial) {
        RandomStream random(77, static_cast<std::uint32_t>(trial));
        Curve c = shells(0.05 * radius, 2.0 * radius);
        for (std::size_t k = 0; k < c.g.size(); ++k) // an ideal gas: noise as of 30 to 600 pairs a bin
            c.g[k] = 1.0 + normal(random) / std::sqrt(2.0 + 4.0 * static_cast<double>(k));
        CHECK_FALSE(first_minimum(c.r, c.g, radius).has_value());
    }
    Curve rising = shells(0.05 * radius, 2.0 * radius), empty = rising;
    for (std::size_t k = 0; k < rising.g.size(); ++k) {
        rising.g[k] = static_cast<double>(k);
        empty.g[k] = 0.0;
    }
    CHECK_FALSE(first_minimum(rising.r, rising.g, radius).has_value());
    CHECK_FALSE(first_minimum(empty.r, empty.g, radius).has_value());
    CHECK_FALSE(first_minimum({}, {}, radius).has_value());
    const Curve c = shells(0.05 * radius, 2.0 * radius);
    const std::span<const double> r = c.r, g = c.g;
    CHECK_FALSE(
        first_minimum(r.first(45), g.first(45), radius).has_value()); // ends on the way down, at 2.25 a
    CHECK_FALSE(first_minimum(r.first(3), g.first(3), radius).has_value());
    CHECK_THROWS_AS(first_minimum(r, g.first(10), radius), InputError);
}
