// Boundaries as curves: where they lie, how they are joined, and where there are none.

#include "lattice_checks.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;

namespace {

constexpr double tolerance = 1e-8; // of the axes, which are 2 long

struct Traced {
    Summary summary;
    double cell = 0.0; ///< side of the finest
};

Traced traced(Design design, const Map& map, double to = tolerance) {
    const Scratch scratch;
    design.boundary_tolerance = to;
    return {run_scan(design, scratch / "l", map), 2.0 / static_cast<double>(design.resolution)};
}

/// Largest distance of consecutive points, in cells.
double largest_gap(const Curve& curve, double cell) {
    double gap = 0.0;
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
        const At &a = curve.points[i - 1].at, &b = curve.points[i].at;
        gap = std::max(gap, std::hypot(a[0] - b[0], a[1] - b[1]) / cell);
    }
    return gap;
}

bool is_closed(const Curve& curve) {
    return curve.points.size() > 2 && curve.points.front().at == curve.points.back().at;
}

/// Largest of |distance(point)|, in units of what the errors of the points allow (axes are 2 long).
template<class Distance>
double largest_miss(const Curve& curve, Distance distance) {
    double miss = 0.0;
    for (const BoundaryPoint& point : curve.points)
        miss = std::max(miss, std::abs(distance(point.at)) / (2.0 * point.error));
    return miss;
}

std::size_t points_of(const std::vector<Curve>& curves) {
    std::size_t points = 0;
    for (const Curve& curve : curves)
        points += curve.points.size();
    return points;
}

/// Edges of finest cells of the whole lattice whose ends differ and have outcomes.
std::size_t crossed_in_lattice(const Design& design, const Map& map) {
    const Lattice lattice(design);
    const std::int64_t fine = lattice.stride(lattice.levels());
    std::size_t crossed = 0;
    for (std::int64_t i = 0; i <= design.resolution; ++i)
        for (std::int64_t j = 0; j <= design.resolution; ++j)
            for (const std::size_t axis : {0, 1}) {
                Lattice::LatticePoint high{i * fine, j * fine, 0};
                const int a = map(lattice.point(high).at);
                if ((high[axis] += fine) > lattice.steps(axis))
                    continue;
                const int b = map(lattice.point(high).at);
                crossed += a != b && a >= 0 && b >= 0;
            }
    return crossed;
}

} // namespace

TEST_CASE("A circle is one closed curve, within the error it states") {
    const auto radius = GENERATE(0.6, 0.3333, 0.05);
    const auto [summary, cell] = traced(adaptive(2, 16, 256), circle(radius, 0.02, 0.01));
    REQUIRE(summary.curves.size() == 1);
    const Curve& curve = summary.curves[0];
    CHECK(curve.outcome_a == 0);
    CHECK(curve.outcome_b == 1);
    CHECK(is_closed(curve));
    CHECK(largest_gap(curve, cell) <= std::sqrt(2.0)); // both points are on one cell
    CHECK(largest_miss(curve,
                       [&](const At& at) { return std::hypot(at[0] - 0.02, at[1] - 0.01) - radius; }) <= 1.0);
    for (const BoundaryPoint& point : curve.points) {
        CHECK(point.error <= 0.5 * tolerance);
        CHECK(point.error > 0.1 * tolerance); // not bisected further than asked
    }
    CHECK(curve.points.size() == crossed_in_lattice(adaptive(2, 16, 256), circle(radius, 0.02, 0.01)) + 1);
}

TEST_CASE("A half plane has one open curve from end to end") {
    const auto map = [](const At& at) { return 0.3 * at[0] + 0.8 * at[1] < 0.2 ? 1 : 0; };
    const auto [summary, cell] = traced(adaptive(2, 16, 256), map);
    REQUIRE(summary.curves.size() == 1);
    const Curve& curve = summary.curves[0];
    CHECK_FALSE(is_closed(curve));
    CHECK(largest_gap(curve, cell) <= std::sqrt(2.0));
    // distance along an axis is at most the sum over sin and cos of the slope: 1/0.3
    CHECK(largest_miss(curve, [](const At& at) { return 0.3 * at[0] + 0.8 * at[1] - 0.2; }) <= 1.0);
    for (const BoundaryPoint* end : {&curve.points.front(), &curve.points.back()})
        CHECK(std::abs(end->at[0]) == 1.0);
    CHECK(curve.points.front().at[0] == -curve.points.back().at[0]);
}

TEST_CASE("Curves that meet an axis at a corner, and one along a row of places, are whole") {
    const auto diagonal = [](const At& at) { return at[0] < at[1] ? 0 : 1; };
    const auto row = [](const At& at) { return at[1] < 0.25 ? 0 : 1; };
    for (const Map& map : {Map(diagonal), Map(row)}) {
        const auto [summary, cell] = traced(adaptive(2, 16, 128), map);
        REQUIRE(summary.curves.size() == 1);
        CHECK(points_of(summary.curves) == crossed_in_lattice(adaptive(2, 16, 128), map));
        CHECK(largest_gap(summary.curves[0], cell) <= std::sqrt(2.0));
    }
}

TEST_CASE("Two circles are two curves, rings many, each closed or ending at an end of an axis") {
    const auto two = [](const At& at) {
        return std::min(circle(0.3, -0.5, 0.1)(at), circle(0.2, 0.5, -0.1)(at));
    };
    const auto rings = [](const At& at) { return static_cast<int>(std::hypot(at[0], at[1]) * 5.9) % 2; };
    CHECK(traced(adaptive(2, 32, 256), two).summary.curves.size() == 2);
    const auto [summary, cell] = traced(adaptive(2, 32, 256), rings);
    for (const Curve& curve : summary.curves) {
        const auto at_end = [](const BoundaryPoint& p) {
            return std::abs(p.at[0]) == 1.0 || std::abs(p.at[1]) == 1.0;
        };
        CHECK((is_closed(curve) || (at_end(curve.points.front()) && at_end(curve.points.back()))));
        CHECK(largest_gap(curve, cell) <= std::sqrt(2.0));
    }
    // radii 1/5.9 ... 5/5.9; larger ones are cut in four arcs
    CHECK(std::ranges::count_if(summary.curves, is_closed) == 5);
}

TEST_CASE("Three outcomes that meet in a point have three boundaries that end there") {
    const auto map = [](const At& at) {
        const double angle = std::atan2(at[1] - 0.011, at[0] + 0.023);
        return angle < -1.0 ? 0 : angle < 1.2 ? 1 : angle < 2.9 ? 2 : 0;
    };
    const auto [summary, cell] = traced(adaptive(2, 16, 256), map);
    std::map<std::pair<int, int>, int> curves;
    for (const Curve& curve : summary.curves) {
        ++curves[{curve.outcome_a, curve.outcome_b}];
        CHECK_FALSE(is_closed(curve));
        const auto from_centre = [](const BoundaryPoint& p) {
            return std::hypot(p.at[0] + 0.023, p.at[1] - 0.011);
        };
        CHECK(std::min(from_centre(curve.points.front()), from_centre(curve.points.back())) < 2.0 * cell);
    }
    CHECK(curves == std::map<std::pair<int, int>, int>{{{0, 1}, 1}, {{0, 2}, 1}, {{1, 2}, 1}});
}

TEST_CASE("No crossing is lost, whatever meets in a cell") {
    const auto quarters = [](const At& at) {
        return at[0] < 0.01 ? (at[1] < -0.37 ? 0 : 1) : (at[1] < -0.37 ? 2 : 0);
    };
    const auto chessboard = [](const At& at) { // saddles in every fourth cell
        return (static_cast<int>(std::floor(at[0] * 16.0 + 0.3)) +
                static_cast<int>(std::floor(at[1] * 16.0 + 0.3))) &
               1;
    };
    const auto dust = [](const At& at) { // three outcomes, neighbours at random
        return static_cast<int>(
            std::fmod(std::abs(std::sin(at[0] * 12.9898 + at[1] * 78.233)) * 43758.5453, 3.0));
    };
    for (const Map& map : {Map(quarters), Map(chessboard), Map(dust)}) {
        const Design design = adaptive(2, 64, 64);             // the whole lattice
        const auto [summary, cell] = traced(design, map, 0.1); // wider than an edge: nothing is bisected
        std::size_t points = 0;
        for (const Curve& curve : summary.curves) {
            points += curve.points.size() - (is_closed(curve) ? 1 : 0);
            CHECK(largest_gap(curve, cell) <= std::sqrt(2.0));
        }
        CHECK(points == crossed_in_lattice(design, map));
    }
}

TEST_CASE("Points that failed have no boundary") {
    const auto map = [](const At& at) { return at[0] < 0.1 ? -1 : at[1] < 0.2 ? 0 : 1; };
    const auto [summary, cell] = traced(adaptive(2, 16, 256), map);
    REQUIRE(summary.curves.size() == 1);
    for (const BoundaryPoint& point : summary.curves[0].points) {
        CHECK(std::abs(point.at[1] - 0.2) <= 2.0 * point.error);
        CHECK(point.at[0] >= 0.1);
    }
}

TEST_CASE("A failure on the way to a boundary costs that place and no other") {
    const Design design = adaptive(2, 16, 64);
    const Map map = circle(0.6);
    const auto whole = traced(design, map);
    // middles between 0.55 and 0.65 fail in a sector; corners of cells do not lie on it
    const auto failing = [&](const At& at) {
        const bool is_corner =
            std::abs(std::remainder(at[0], 1.0 / 32.0)) + std::abs(std::remainder(at[1], 1.0 / 32.0)) < 1e-12;
        return !is_corner && at[0] > 0.0 && std::abs(at[1]) < 0.1 ? -1 : map(at);
    };
    const auto some = traced(design, failing);
    const std::size_t lost = points_of(whole.summary.curves) - points_of(some.summary.curves);
    CHECK(lost > 0);
    CHECK(lost < 12); // of 6 rows and their columns
    for (const Curve& curve : some.summary.curves)
        CHECK(largest_miss(curve, [](const At& at) { return std::hypot(at[0], at[1]) - 0.6; }) <= 1.0);
}

TEST_CASE("One axis: the places where the outcome changes") {
    const auto map = [](const At& at) { return at[0] < -0.3 ? 0 : at[0] < 0.7 ? 1 : 0; };
    const auto [summary, cell] = traced(adaptive(1, 16, 64), map);
    REQUIRE(summary.curves.size() == 1);
    REQUIRE(summary.curves[0].points.size() == 2);
    CHECK(std::abs(summary.curves[0].points[0].at[0] + 0.3) <= 2.0 * summary.curves[0].points[0].error);
    CHECK(std::abs(summary.curves[0].points[1].at[0] - 0.7) <= 2.0 * summary.curves[0].points[1].error);
}

TEST_CASE("Three axes: every edge of the finest cells that crosses, on the sphere") {
    const auto ball = [](const At& at) { return std::hypot(at[0], at[1], at[2]) < 0.7 ? 0 : 1; };
    const auto [summary, cell] = traced(adaptive(3, 8, 32), ball);
    REQUIRE(summary.curves.size() == 1);
    CHECK(summary.curves[0].points.size() > 1000);
    CHECK(largest_miss(summary.curves[0],
                       [](const At& at) { return std::hypot(at[0], at[1], at[2]) - 0.7; }) <= 1.0);
}

TEST_CASE("On a logarithmic axis errors are fractions of the axis") {
    Design design = adaptive(2, 16, 64);
    design.axes[0] = axis("x", 0.01, 100.0, 16);
    design.axes[0].spacing = Spacing::log;
    const auto map = [](const At& at) { return at[0] < 3.7 ? 0 : 1; };
    const auto [summary, cell] = traced(design, map);
    REQUIRE(summary.curves.size() == 1);
    for (const BoundaryPoint& point : summary.curves[0].points) {
        CHECK(point.error <= 0.5 * tolerance);
        CHECK(std::abs(std::log(point.at[0] / 3.7)) <= point.error * std::log(1e4) * (1.0 + 1e-6));
    }
}

TEST_CASE("The measures of curves can fail") {
    const Curve curve{0, 1, {{{0.0, 0.0}, 1e-3}, {{1.0, 0.0}, 1e-3}, {{1.0, 1.0}, 1e-3}}};
    CHECK_FALSE(is_closed(curve));
    CHECK(largest_gap(curve, 0.5) == 2.0);
    CHECK(largest_miss(curve, [](const At& at) { return at[1]; }) == Approx(500.0));
}

TEST_CASE("Bisection keeps the half whose ends differ, of a third outcome the lower") {
    const auto halved = [](int at_middle) {
        OutcomeChange crossing{1, 0, 1, 0.25, 0.5};
        Result result;
        result.outcome = at_middle;
        result.status = at_middle < 0 ? Status::failed : Status::ok;
        bisect(crossing, result);
        return crossing;
    };
    CHECK(halved(0).u_low == 0.375);
    CHECK(halved(0).u_high == 0.5);
    CHECK(halved(1).u_low == 0.25);
    CHECK(halved(1).u_high == 0.375);
    CHECK(halved(2).u_high == 0.375);
    CHECK(halved(2).outcome_high == 2);
    CHECK(halved(-1).outcome_high == -1);
}

// --- The audit of what was not refined: rate, bound, and what becomes of what it finds

TEST_CASE("The upper bound is that of Clopper and Pearson") {
    // one-sided 95 %; without a hit 1 - 0.05^(1/n), else the root of the binomial sum (qbeta(0.95, k + 1, n -
    // k))
    CHECK(Audit{1000, 0}.upper_bound() == Approx(0.0029912495).epsilon(1e-7));
    CHECK(Audit{100, 0}.upper_bound() == Approx(1.0 - std::pow(0.05, 0.01)).epsilon(1e-10));
    CHECK(Audit{100, 5}.upper_bound() == Approx(0.1022533776).epsilon(1e-7));
    CHECK(Audit{20, 19}.upper_bound() == Approx(std::pow(0.95, 0.05)).epsilon(1e-10));
    CHECK(Audit{20, 20}.upper_bound() == 1.0);
    CHECK(Audit{0, 0}.upper_bound() == 1.0);
    CHECK(Audit{0, 0}.rate() == 0.0);
    CHECK(Audit{50, 5}.rate() == 0.1);
}

TEST_CASE("Places of an audit are distinct, unknown, and not at a boundary") {
    Design design = adaptive(2, 16, 256);
    design.audit = 500;
    const Refinement refinement = refined(design, circle(0.6));
    const auto points = audit_points(refinement, design, 0);
    CHECK(points.size() == 500);
    std::set<std::int64_t> ids;
    for (const Point& point : points) {
        ids.insert(point.id);
        CHECK_FALSE(refinement.knows(point.id));
        CHECK_FALSE(refinement.leaf_at(refinement.lattice().place(point.id)).mixed);
        CHECK(point.at == refinement.lattice().point(refinement.lattice().place(point.id)).at);
        CHECK_FALSE(is_missed(refinement, result_of(circle(0.6), point)));
    }
    CHECK(ids.size() == 500);
    CHECK(std::ranges::is_sorted(points, {}, &Point::id));
}

TEST_CASE("An audit has other places in another round and for another seed, and the same ones again") {
    Design design = adaptive(2, 16, 4096);
    design.audit = 200;
    const Refinement refinement = refined(design, [](const At&) { return 1; });
    const auto ids = [&](std::uint32_t round) {
        std::set<std::int64_t> found;
        for (const Point& point : audit_points(refinement, design, round))
            found.insert(point.id);
        return found;
    };
    const auto first = ids(0);
    CHECK(ids(0) == first);
    CHECK(ids(1) != first);
    design.seed = 2;
    CHECK(ids(0) != first);
}

TEST_CASE("Where nothing is left to try, the audit tries less") {
    Design design = adaptive(2, 16, 16);
    design.audit = 100;
    const Refinement refinement = refined(design, circle(0.6));
    CHECK(audit_points(refinement, design, 0).empty());
    const Scratch scratch;
    const Summary summary = run_scan(design, scratch / "l", circle(0.6));
    CHECK(summary.complete);
    CHECK(summary.audit.tried == 0);
    CHECK(summary.audit.upper_bound() == 1.0);
}

TEST_CASE("The rate of a planted island is found within its binomial error") {
    // An island between the corners of the start: 0.05 of a cell of 1/8 around it. The lattice has 513^2
    // places, of which those in the island are missed.
    const Map island = [](const At& at) {
        return std::max(std::abs(at[0] - 0.0625), std::abs(at[1] - 0.0625)) < 0.05;
    };
    Design design = adaptive(2, 16, 512);
    design.audit = 2000;
    const Refinement refinement = refined(design, island);
    std::int64_t in_island = 0, known = 17 * 17;
    for (std::int64_t i = 0; i <= 512; ++i)
        for (std::int64_t j = 0; j <= 512; ++j)
            in_island +=
                island({-1.0 + static_cast<double>(i) / 256.0, -1.0 + static_cast<double>(j) / 256.0}) == 1;
    const double rate = static_cast<double>(in_island) / static_cast<double>(513 * 513 - known);
    REQUIRE(in_island > 0);
    std::int64_t tried = 0, missed = 0;
    int above = 0;
    constexpr int seeds = 50;
    for (int seed = 1; seed <= seeds; ++seed) {
        design.seed = static_cast<std::uint64_t>(seed);
        Audit audit;
        for (const Point& point : audit_points(refinement, design, 0)) {
            ++audit.tried;
            audit.missed += is_missed(refinement, result_of(island, point));
        }
        tried += audit.tried;
        missed += audit.missed;
        above += audit.upper_bound() >= rate;
    }
    // four standard errors of 100 000 places: chance 6e-5; the seeds are fixed
    const double error = std::sqrt(rate * (1.0 - rate) / static_cast<double>(tried));
    CHECK(std::abs(static_cast<double>(missed) / static_cast<double>(tried) - rate) < 4.0 * error);
    // 95 % or more of the bounds hold; of 50 fewer than 43 have a chance of 2e-3 at 95 %
    CHECK(above >= 43);
}

TEST_CASE("A scan refines what its audit finds, and tells both") {
    const Map island = circle(0.05, 0.06, 0.06);
    Design design = adaptive(2, 16, 256);
    const Scratch scratch;
    const Lattice lattice(design);
    const Summary blind = run_scan(design, scratch / "blind", island);
    CHECK(blind.audit_rounds == 0);
    CHECK(wrong_places(lattice, blind.leaves, island) > 0);
    design.audit = 2000; // of 257^2 places 129 in the island: 4 are expected
    const Summary seeing = run_scan(design, scratch / "seeing", island);
    CHECK(seeing.complete);
    CHECK(wrong_places(lattice, seeing.leaves, island) == 0);
    CHECK(seeing.found_by_audit > 0);
    CHECK(seeing.audit_rounds >= 2);
    CHECK(seeing.audit.missed == 0); // of the last round
    CHECK(seeing.audit.tried == 2000);
    CHECK_FALSE(tiling(lattice, seeing.leaves).empty());
    CHECK(is_balanced(lattice, seeing.leaves));
}

TEST_CASE("An island of failures is found too") {
    const Map island = [](const At& at) { return std::hypot(at[0] - 0.06, at[1] - 0.06) < 0.05 ? -1 : 1; };
    Design design = adaptive(2, 16, 256);
    design.audit = 2000;
    const Scratch scratch;
    const Summary summary = run_scan(design, scratch / "l", island);
    CHECK(summary.found_by_audit > 0);
    CHECK(wrong_places(Lattice(design), summary.leaves, island) == 0);
}
