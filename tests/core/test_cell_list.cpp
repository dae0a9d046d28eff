// Who is near whom by cells, against all pairs; and bond order, against its definition.

#include "rodwake/core/bond_order.hpp"
#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <set>

using namespace rodwake;

namespace {

using PairSet = std::set<std::pair<std::size_t, std::size_t>>;

struct Points {
    std::vector<double> x, y;
    PeriodicBox box;
};

/// Some boxes away from the origin, as unwrapped places are.
Points random_points(std::size_t count, const PeriodicBox& box, std::uint64_t seed) {
    RandomStream random(seed);
    Points p{{}, {}, box};
    for (std::size_t i = 0; i < count; ++i) {
        p.x.push_back(random.uniform(-2.0 * box.x, 2.0 * box.x));
        p.y.push_back(random.uniform(-2.0 * box.y, 2.0 * box.y));
    }
    return p;
}

/// A perfect triangular lattice cannot close in a square; the triangles here are equilateral in a strip of
/// it.
Points triangle_patch(double spacing, double turn) {
    Points p;
    p.box = 100.0 * spacing;
    for (int i = -6; i <= 6; ++i)
        for (int j = -6; j <= 6; ++j) {
            const double u = spacing * (i + 0.5 * j), v = spacing * std::sqrt(0.75) * j;
            p.x.push_back(u * std::cos(turn) - v * std::sin(turn));
            p.y.push_back(u * std::sin(turn) + v * std::cos(turn));
        }
    return p;
}

PairSet all_near(const Points& p, double reach) {
    PairSet pairs;
    for (std::size_t i = 0; i < p.x.size(); ++i)
        for (std::size_t j = i + 1; j < p.x.size(); ++j)
            if (nearest_distance(p.x[i] - p.x[j], p.y[i] - p.y[j], p.box) < reach)
                pairs.emplace(i, j);
    return pairs;
}

/// Candidates of the cells; `twice` counts those seen again.
PairSet candidates(const CellList& cells, int& twice) {
    PairSet pairs;
    cells.pairs([&](std::size_t p, std::size_t q) {
        const std::size_t i = cells.member()[p], j = cells.member()[q];
        twice += pairs.emplace(std::min(i, j), std::max(i, j)).second ? 0 : 1;
    });
    return pairs;
}

std::vector<std::complex<double>> plain_psi6(const Points& p, double cutoff) {
    std::vector<std::complex<double>> psi(p.x.size());
    for (std::size_t i = 0; i < p.x.size(); ++i) {
        int near = 0;
        for (std::size_t j = 0; j < p.x.size(); ++j) {
            const double dx = std::remainder(p.x[j] - p.x[i], p.box.x),
                         dy = std::remainder(p.y[j] - p.y[i], p.box.y);
            if (i == j || std::hypot(dx, dy) >= cutoff)
                continue;
            psi[i] += std::polar(1.0, 6.0 * std::atan2(dy, dx));
            ++near;
        }
        if (near > 0)
            psi[i] /= near;
    }
    return psi;
}

LocalOrder order_of(const Points& p, double cutoff) {
    return bond_order(p.x.size(), bonds_within(p.x, p.y, p.box, cutoff));
}

} // namespace

TEST_CASE("cells miss no near pair and show none twice, however many there are") {
    std::uint64_t seed = 60;
    for (const double reach : {0.01, 0.1, 0.26, 0.34, 0.6, 3.0}) // 3 and fewer than 3 along a side among them
        for (const PeriodicBox box : {PeriodicBox(1.0), PeriodicBox(1.6, 0.7), PeriodicBox(0.4, 5.0)}) {
            const Points p = random_points(150, box, ++seed);
            const CellList cells(p.x, p.y, p.box, reach);
            CHECK((cells.columns() == 1 || cells.width() >= reach));
            CHECK((cells.rows() == 1 || cells.height() >= reach));
            int twice = 0;
            const PairSet seen = candidates(cells, twice), wanted = all_near(p, reach);
            CHECK(twice == 0);
            CHECK(std::ranges::includes(seen, wanted));
            PairSet around; // by the nine cells around each place
            for (std::size_t i = 0; i < p.x.size(); ++i)
                cells.around(cells.column(p.x[i]), cells.row(p.y[i]), [&](std::size_t k) {
                    if (cells.member()[k] > i)
                        around.emplace(i, cells.member()[k]);
                });
            CHECK(around == seen);
        }
}

TEST_CASE("a cell list keeps places as given, in the order of cells, and few cells for few places") {
    const Points p = random_points(40, 2.0, 70);
    const CellList cells(p.x, p.y, p.box, 0.2);
    for (std::size_t k = 0; k < 40; ++k) {
        CHECK(cells.x()[k] == p.x[cells.member()[k]]);
        CHECK(cells.y()[k] == p.y[cells.member()[k]]);
    }
    CHECK(cells.columns() == 10);
    CHECK(cells.rows() == 10);
    CHECK(CellList(p.x, p.y, p.box, 1e-9).columns() < 20);
    CHECK(CellList(p.x, p.y, {2.0, 8.0}, 0.3).rows() == 26);
    CHECK(CellList(p.x, p.y, {1e15, 2.0}, 0.3).columns() < 2000); // mostly empty
    CHECK(CellList({}, {}, 1.0, 0.1).member().empty());
    CHECK(cells.column(-1e-20) == 0);
    CHECK(cells.column(1.9999) == 9);
    std::size_t found = 0;
    for (std::ptrdiff_t row = -10; row < 0; ++row)
        for (std::ptrdiff_t column = 0; column < 10; ++column)
            cells.in_cell(column, row, [&](std::size_t) { ++found; });
    CHECK(found == 40);
}

TEST_CASE("psi_6 is 1 inside a perfect crystal, whatever its direction") {
    for (const double turn : {0.0, 0.3, 1.0}) {
        const LocalOrder order = order_of(triangle_patch(1.0, turn), 1.4);
        for (const std::size_t middle : {84u, 70u}) { // all six neighbours are there
            CHECK(order.neighbours[middle] == 6);
            CHECK(std::abs(std::abs(order.psi[middle]) - 1.0) < 1e-14);
            CHECK(std::abs(order.psi[middle] - std::polar(1.0, 6.0 * turn)) <
                  1e-13); // 6 x rounding of places up to 10
        }
        CHECK(std::abs(order.global() - 1.0) < 1e-14); // edges miss neighbours, not directions
    }
}

TEST_CASE("psi_6 equals the sum over all pairs") {
    for (const PeriodicBox box : {PeriodicBox(4.0), PeriodicBox(10.0, 7.0), PeriodicBox(20.0, 40.0)}) {
        const Points p = random_points(200, box, 51);
        const LocalOrder order = order_of(p, 1.5);
        const auto wanted = plain_psi6(p, 1.5);
        double worst = 0.0;
        std::complex<double> sum = 0.0;
        for (std::size_t i = 0; i < order.psi.size(); ++i) {
            worst = std::max(worst, std::abs(order.psi[i] - wanted[i]));
            sum += wanted[i];
        }
        CHECK(worst < 1e-12); // 6 x rounding of places of 80 over bonds of 0.01 and more
        CHECK(order.global() == Approx(std::abs(sum) / 200.0).margin(1e-12));
    }
    const Points p = random_points(50, 10.0, 51);
    CHECK(std::abs(order_of(p, 1.5).global() - order_of(p, 1.6).global()) > 1e-6); // the check can fail
}

TEST_CASE("bonds come from either end, sorted, whatever the cells are") {
    const Points p = random_points(300, 10.0, 55);
    const std::vector<Bond> bonds = bonds_within(p.x, p.y, p.box, 1.0);
    CHECK(bonds.size() == 2 * all_near(p, 1.0).size());
    CHECK(std::ranges::is_sorted(bonds, [](const Bond& a, const Bond& b) {
        return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    }));
}

TEST_CASE("places at random have psi_6 of about 1/sqrt(N)") {
    const std::size_t count = 2000;
    double squares = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed)
        squares += std::pow(order_of(random_points(count, 60.0, 100 + seed), 2.0).global(), 2) / 20.0;
    const double rms = std::sqrt(squares) * std::sqrt(static_cast<double>(count));
    CHECK(rms > 0.5); // neighbours share bonds, so not exactly 1; 20 draws scatter by 16 %
    CHECK(rms < 2.0);
}

TEST_CASE("psi_6 of nothing is 0") {
    CHECK(order_of({{}, {}, 1.0}, 0.1).global() == 0.0);
    CHECK(order_of({{0.5}, {0.5}, 1.0}, 0.1).global() == 0.0);
    CHECK(order_of({{0.5, 0.5}, {0.5, 0.5}, 1.0}, 0.1).psi[0] == 0.0); // on the same spot: no direction
}

// --- The three forms of the nearest image against each other, and their domains

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
