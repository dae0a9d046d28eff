// psi_6 of single beads on lattices, against its definition, and Delaunay neighbours against empty circles.

#include "order_beds.hpp"

#include "measure/pair_counts.hpp"
#include "measure/psi6.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "support/instruction_sets.hpp"
#include "support/normal.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

using namespace rodwake;
using namespace rodwake::measure;
using namespace order_beds;
using order_beds::radius;

namespace {

using Psi = std::vector<std::complex<double>>;

double largest_difference(const Psi& a, const Psi& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

/// Bonds as (from, to, image in x, image in y), sorted.
using BondList = std::vector<std::array<long, 4>>;

BondList listed(const Bed& bed, const std::vector<Bond>& bonds) {
    BondList list;
    for (const Bond& b : bonds)
        list.push_back({static_cast<long>(b.from), static_cast<long>(b.to),
                        std::lround((b.dx - (bed.x[b.to] - bed.x[b.from])) / bed.box),
                        std::lround((b.dy - (bed.y[b.to] - bed.y[b.from])) / bed.box)});
    std::ranges::sort(list);
    return list;
}

struct Circle {
    double x, y, r2;
};

/// Through the origin and two points; r2 = infinity if they are on a line.
Circle around(double ax, double ay, double bx, double by) {
    const double d = 2.0 * (ax * by - ay * bx), a2 = ax * ax + ay * ay, b2 = bx * bx + by * by;
    if (d == 0.0)
        return {0.0, 0.0, std::numeric_limits<double>::infinity()};
    const double x = (by * a2 - ay * b2) / d, y = (ax * b2 - bx * a2) / d;
    return {x, y, x * x + y * y};
}

/// By definition: two beads are neighbours if they lie on a circle with a third one and none is inside.
BondList by_empty_circles(const Bed& bed) {
    BondList list;
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
        std::vector<std::array<double, 2>> at;
        BondList name;
        for (long m = -2; m <= 2; ++m)
            for (long n = -2; n <= 2; ++n)
                for (std::size_t j = 0; j < bed.x.size(); ++j) {
                    const double dx = bed.x[j] - bed.x[i] + static_cast<double>(m) * bed.box,
                                 dy = bed.y[j] - bed.y[i] + static_cast<double>(n) * bed.box;
                    if ((j == i && m == 0 && n == 0) || std::hypot(dx, dy) > 1.5 * bed.box)
                        continue;
                    at.push_back({dx, dy});
                    name.push_back({static_cast<long>(i), static_cast<long>(j), m, n});
                }
        for (std::size_t p = 0; p < at.size(); ++p)
            for (std::size_t q = 0; q < p; ++q) {
                const Circle c = around(at[p][0], at[p][1], at[q][0], at[q][1]);
                if (c.r2 > bed.box * bed.box) // no empty circle is as wide as box/sqrt(2)
                    continue;
                const bool empty = std::ranges::none_of(at, [&](const auto& o) {
                    const double x = o[0] - c.x, y = o[1] - c.y;
                    return x * x + y * y < c.r2 * (1.0 - 1e-12);
                });
                if (empty)
                    list.insert(list.end(), {name[p], name[q]});
            }
    }
    std::ranges::sort(list);
    const auto twice = std::ranges::unique(list);
    list.erase(twice.begin(), twice.end());
    return list;
}

} // namespace

TEST_CASE("every bead of a perfect hexagon has |psi_6| = 1", "[psi6]") {
    for (const double turn : {0.0, 0.3, 1.0}) {
        const Bed bed = hexagon(5, 2.1 * radius, turn, 78.0 * radius);
        const LocalOrder order = order_by_cutoff(bed.x, bed.y, bed.box, 3.0 * radius);
        // bonds are off by roundings of places, 40 spacings: 1e-14 in angle, which |psi_6| feels squared
        for (const auto& psi : order.psi)
            CHECK(std::abs(std::abs(psi) - 1.0) < 1e-14);
        CHECK(std::abs(order.global() - 1.0) < 1e-14);
        CHECK(order.neighbours[0] == 6);
        // six times the angle: 6 * 1e-14, and as much for the lattice's own places
        CHECK(std::abs(order.psi[0] - std::polar(1.0, 6.0 * turn)) < 2e-13);
        const LocalOrder delaunay = order_by_delaunay(bed.x, bed.y, bed.box);
        CHECK(delaunay.neighbours[0] == 6);
        CHECK(std::abs(std::abs(delaunay.psi[0]) - 1.0) < 1e-14);
    }
}

TEST_CASE("a square lattice has psi_6 = 0 and four neighbours by either rule", "[psi6]") {
    for (const std::size_t side : {4, 7, 30}) {
        const Bed bed = shifted(square_lattice(side, 1.0), 0.123456789, 0.987654321);
        for (const LocalOrder& order :
             {order_by_cutoff(bed.x, bed.y, bed.box, std::min(0.5, 1.2 / static_cast<double>(side))),
              order_by_delaunay(bed.x, bed.y, bed.box)}) {
            CHECK(std::ranges::all_of(order.neighbours, [](int n) { return n == 4; }));
            // opposite bonds add, those across cancel but for roundings of places, side * 1e-16, six times
            for (const auto& psi : order.psi)
                CHECK(std::abs(psi) < 1e-14 * std::max(1.0, static_cast<double>(side) / 10.0));
            CHECK(order.global() < 1e-14);
        }
    }
}

TEST_CASE("psi_6 by cut-off equals its definition", "[psi6]") {
    for (const auto& [count, cutoff] :
         {std::pair<std::size_t, double>{2, 0.5}, {30, 0.45}, {100, 0.3}, {700, 0.06}}) {
        const Bed bed = random_bed(count, 1.0, 11 + count);
        CHECK(largest_difference(psi6_by_cutoff(bed.x, bed.y, 1.0, cutoff), plain_psi6(bed, cutoff)) < 1e-12);
        Bed moved = bed; // what is compared can tell
        moved.x[0] = into_box(moved.x[0] + 0.01, 1.0);
        if (count > 30)
            CHECK(largest_difference(psi6_by_cutoff(moved.x, moved.y, 1.0, cutoff), plain_psi6(bed, cutoff)) >
                  1e-3);
    }
}

TEST_CASE("Delaunay neighbours are those of the empty circles", "[psi6]") {
    for (const std::size_t count : {2, 3, 5, 12, 25}) {
        const Bed bed = random_bed(count, 3.7, 5 + count);
        const BondList bonds = listed(bed, delaunay_bonds(bed.x, bed.y, bed.box));
        CHECK(bonds == by_empty_circles(bed));
        CHECK(bonds.size() == 6 * count); // Euler: a triangulated torus
        BondList fewer = bonds;
        fewer.pop_back();
        CHECK(fewer != by_empty_circles(bed));
    }
    // many beads and large holes, where the margin must grow
    Bed cluster = random_bed(300, 1.0, 99);
    for (double& x : cluster.x)
        x *= 0.1;
    CHECK(delaunay_bonds(cluster.x, cluster.y, 1.0).size() == 6 * 300);
}

TEST_CASE("bonds come from either end, and mean psi_6 over them is the sum of unit vectors", "[psi6]") {
    const Bed bed = random_bed(400, 1.0, 3);
    const auto bonds = delaunay_bonds(bed.x, bed.y, 1.0);
    BondList there = listed(bed, bonds), back;
    for (const auto& b : there)
        back.push_back({b[1], b[0], -b[2], -b[3]});
    std::ranges::sort(back);
    CHECK(there == back);
    Psi psi(400);
    std::vector<double> count(400, 0.0);
    for (const Bond& b : bonds) {
        psi[b.from] += std::polar(1.0, 6.0 * std::atan2(b.dy, b.dx));
        count[b.from] += 1.0;
    }
    for (std::size_t i = 0; i < psi.size(); ++i)
        psi[i] /= count[i];
    CHECK(largest_difference(psi, psi6_by_delaunay(bed.x, bed.y, 1.0)) < 1e-12);
}

TEST_CASE("one bead, beads in one place, and none", "[psi6]") {
    CHECK(psi6_by_cutoff({}, {}, 1.0, 0.2).empty());
    CHECK(psi6_by_delaunay({}, {}, 1.0).empty());
    CHECK(order_by_cutoff({0.5}, {0.5}, 1.0, 0.2).neighbours[0] == 0);
    CHECK(psi6_by_cutoff({0.5, 0.5}, {0.5, 0.5}, 1.0, 0.2) == Psi(2)); // no direction
    const LocalOrder alone = order_by_delaunay({0.5}, {0.5}, 1.0);     // a square lattice of its images
    CHECK(alone.neighbours[0] == 4);
    CHECK(std::abs(alone.psi[0]) < 1e-14);
    const LocalOrder twins = order_by_delaunay({0.5, 0.5}, {0.5, 0.5}, 1.0);
    CHECK(twins.neighbours == std::vector<int>{4, 4}); // they do not see each other
}

TEST_CASE("moving all beads together changes psi_6 by rounding alone", "[psi6]") {
    const Bed bed = random_bed(200, 1.0, 17);
    const Psi cutoff = psi6_by_cutoff(bed.x, bed.y, 1.0, 0.1), delaunay = psi6_by_delaunay(bed.x, bed.y, 1.0);
    for (const auto& [dx, dy] : {std::pair<double, double>{0.5, 0.25}, {0.1234, -0.777}, {-0.9, 0.9}}) {
        const Bed there = shifted(bed, dx, dy);
        // bonds of 1e-3 or more are off by 2e-16: 2e-13 in angle, six times
        CHECK(largest_difference(psi6_by_cutoff(there.x, there.y, 1.0, 0.1), cutoff) < 1e-11);
        CHECK(largest_difference(psi6_by_delaunay(there.x, there.y, 1.0), delaunay) < 1e-11);
    }
}

TEST_CASE("places outside the box and useless cut-offs are refused", "[psi6]") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {-0.1, 1.0, 7.0, nan}) {
        CHECK_THROWS_AS(psi6_by_cutoff({0.1, bad}, {0.1, 0.2}, 1.0, 0.2), InputError);
        CHECK_THROWS_AS(psi6_by_delaunay({0.1, 0.2}, {bad, 0.2}, 1.0), InputError);
    }
    for (const double cutoff : {0.0, -1.0, 0.51, nan})
        CHECK_THROWS_AS(psi6_by_cutoff({0.1}, {0.1}, 1.0, cutoff), InputError);
    CHECK_THROWS_AS(psi6_by_cutoff({0.1, 0.2}, {0.1}, 1.0, 0.2), InputError);
}

// --- The first minimum of g(r) on curves whose minimum is known

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

// --- The vectorised part of the pair loop gives the bits of the plain loop on every instruction set

namespace {

struct Row {
    std::vector<std::int32_t> bin;
    std::vector<double> order;

    bool operator==(const Row&) const = default;
};

/// x, y, re, im of beads, with room for whole vectors.
using Columns = std::vector<std::vector<double>>;

Columns random_columns(std::size_t count, double box) {
    RandomStream random(31);
    Columns c(4, std::vector<double>(count + padding, 0.0));
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t i = 0; i < count; ++i)
            c[k][i] = k < 2 ? random.uniform(0.0, box) : random.uniform(-1.0, 1.0);
    return c;
}

Row vector_row(const Columns& c, std::size_t i, std::size_t count, double box, double per_bin) {
    Row row{std::vector<std::int32_t>(count + padding), std::vector<double>(count + padding)};
    fill_pair_row({c[0].data(), c[1].data(), c[2].data(), c[3].data()}, i, count, box, per_bin,
                  row.bin.data(), row.order.data());
    row.bin.resize(count);
    row.order.resize(count);
    return row;
}

Row plain_row(const Columns& c, std::size_t i, std::size_t count, double box, double per_bin) {
    const auto apart = [box](double a, double b) { return std::min(std::abs(a - b), box - std::abs(a - b)); };
    Row row;
    for (std::size_t j = i + 1; j <= i + count; ++j) {
        const double dx = apart(c[0][j], c[0][i]), dy = apart(c[1][j], c[1][i]);
        row.bin.push_back(static_cast<std::int32_t>(std::sqrt(dx * dx + dy * dy) * per_bin));
        row.order.push_back(c[2][j] * c[2][i] + c[3][j] * c[3][i]);
    }
    return row;
}

} // namespace

TEST_CASE("rows of pairs are the same to the bit on every instruction set", "[order]") {
    const double box = 3.3;
    Columns c = random_columns(70, box);
    for (const std::size_t i : {0, 1, 40, 66, 68}) {
        const std::size_t count = 69 - i;
        const Row wanted = plain_row(c, i, count, box, 17.0);
        int targets = 0;
        for_each_instruction_set([&] {
            CHECK(vector_row(c, i, count, box, 17.0) == wanted);
            ++targets;
        });
        CHECK(targets >= 1);
    }
    c[0][5] = std::nextafter(c[0][5] + 0.2, 0.0); // what is compared can tell
    c[2][6] += 1e-14;                             // a few units in the last place of the product
    const Row before = plain_row(random_columns(70, box), 0, 69, box, 17.0),
              after = vector_row(c, 0, 69, box, 17.0);
    CHECK(after.bin != before.bin);
    CHECK(after.order != before.order);
}
