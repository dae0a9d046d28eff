// The audit of what was not refined: rate, bound, and what becomes of what it finds.

#include "lattice_checks.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;

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
