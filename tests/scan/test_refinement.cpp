// Adaptive refinement on maps whose answer is known, against the full lattice.

#include "lattice_checks.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;

namespace {

struct Case {
    const char* what;
    Design design;
    Map map;
};

std::vector<Case> cases() {
    const auto line = [](const At& at) { return at[0] < 0.1234 ? 0 : 1; };
    const auto band = [](const At& at) { return std::abs(at[0] - 0.3) < 0.02 ? 0 : 1; };
    const auto plane = [](const At& at) { return 0.3 * at[0] + 0.8 * at[1] < 0.2 ? 0 : 1; };
    const auto quarters = [](const At& at) {
        return at[0] < 0.01 ? (at[1] < -0.37 ? 0 : 1) : (at[1] < -0.37 ? 2 : 0);
    };
    const auto waves = [](const At& at) { return at[1] < 0.4 * std::sin(9.0 * at[0]) ? 0 : 1; };
    const auto holes = [](const At& at) { return at[0] + at[1] < -1.2 ? -1 : circle(0.6)(at); };
    const auto ball = [](const At& at) { return std::hypot(at[0], at[1], at[2] - 0.1) < 0.7 ? 0 : 1; };
    const auto space = [](const At& at) { return at[0] + 0.5 * at[1] - 0.7 * at[2] < 0.1 ? 0 : 1; };
    const auto sheet = [](const At& at) { return std::abs(at[2] - 0.31 * at[0] - 0.1) < 0.03 ? 0 : 1; };
    return {{"a place on a line", adaptive(1, 8, 1024), line},
            {"a band on a line, wider than a cell", adaptive(1, 64, 4096), band},
            {"a half plane", adaptive(2, 16, 256), plane},
            {"a circle", adaptive(2, 16, 256), circle(0.6)},
            {"a small circle that holds a corner", adaptive(2, 16, 256), circle(0.02)},
            {"a circle cut by the end of an axis", adaptive(2, 16, 256), circle(0.6, -1.0, 0.9)},
            {"rings", adaptive(2, 32, 256),
             [](const At& at) { return static_cast<int>(std::hypot(at[0], at[1]) * 6.0) % 3; }},
            {"four quarters of three outcomes", adaptive(2, 16, 256), quarters},
            {"waves", adaptive(2, 32, 512), waves},
            {"failures beyond a line", adaptive(2, 16, 128), holes},
            {"a slanted strip of a third of a cell of the start", adaptive(2, 64, 512),
             strip(0.3, 1.0, 0.1, 0.01)},
            {"a steep strip of a fifth of a cell of the start", adaptive(2, 64, 1024),
             strip(1.0, 0.07, 0.4, 0.006)},
            {"one outcome", adaptive(2, 16, 256), [](const At&) { return 1; }},
            {"a ball", adaptive(3, 8, 64), ball},
            {"a half space", adaptive(3, 8, 64), space},
            {"a sheet of a quarter of a cell", adaptive(3, 8, 64), sheet}};
}

} // namespace

TEST_CASE("No place of the full lattice differs from its cell") {
    for (const Case& one : cases()) {
        INFO(one.what);
        const Refinement refinement = refined(one.design, one.map);
        CHECK(wrong_places(refinement.lattice(), refinement.leaves(), one.map) == 0);
    }
}

TEST_CASE("Cells cover the axes exactly, once, and neighbours differ by a factor of two") {
    for (const Case& one : cases()) {
        INFO(one.what);
        const Refinement refinement = refined(one.design, one.map);
        CHECK_FALSE(tiling(refinement.lattice(), refinement.leaves()).empty());
        CHECK(is_balanced(refinement.lattice(), refinement.leaves()));
    }
}

TEST_CASE("The checks of cells can fail") {
    const Design design = adaptive(2, 16, 256);
    const Refinement refinement = refined(design, circle(0.6));
    const Lattice& lattice = refinement.lattice();
    std::vector<Leaf> leaves = refinement.leaves();
    CHECK(wrong_places(lattice, leaves, circle(0.61)) > 0);
    CHECK(wrong_places(lattice, leaves, circle(0.02, 0.9, 0.9)) > 0);
    auto missing = leaves;
    missing.pop_back();
    CHECK(tiling(lattice, missing).empty());
    auto twice = leaves;
    twice.push_back(twice.front());
    CHECK(tiling(lattice, twice).empty());
    auto coarse = refined(adaptive(2, 16, 16), circle(0.6)).leaves();
    CHECK(wrong_places(lattice, coarse, circle(0.6)) > 0); // mixed, and not of the finest size
    // one cell of the start, divided to the finest
    std::erase_if(coarse, [](const Leaf& leaf) { return leaf.low == Lattice::LatticePoint{}; });
    const std::int64_t side = lattice.stride(lattice.levels());
    for (std::int64_t i = 0; i < 16; ++i)
        for (std::int64_t j = 0; j < 16; ++j)
            coarse.push_back({{i * side, j * side, 0}, side, 1, false});
    CHECK_FALSE(tiling(lattice, coarse).empty());
    CHECK_FALSE(is_balanced(lattice, coarse));
}

TEST_CASE("Points are asked for once, in the order of their numbers, and a part of the lattice is enough") {
    const Design design = adaptive(2, 16, 512);
    Refinement refinement(design);
    std::set<std::int64_t> asked;
    for (auto points = refinement.next(); !points.empty(); points = refinement.next()) {
        CHECK(std::ranges::is_sorted(points, {}, &Point::id));
        for (const Point& point : points) {
            CHECK(asked.insert(point.id).second);
            CHECK_FALSE(refinement.knows(point.id));
            refinement.learn(result_of(circle(0.6), point));
            CHECK(refinement.knows(point.id));
        }
    }
    // Around each of 5 levels a ring of 2 pi 0.6/2 2^(4 + level) cells, up to 6 places across: 1.2e4, and
    // 17^2 of the start.
    CHECK(asked.size() < 13'000);
    CHECK(size(design) == 513 * 513);
}

TEST_CASE("Asking again without an answer asks for the same") {
    Refinement refinement(adaptive(2, 4, 16));
    const auto first = refinement.next(), again = refinement.next();
    REQUIRE(first.size() == 25);
    REQUIRE(again.size() == 25);
    CHECK(again.front().id == first.front().id);
}

TEST_CASE("The order in which results come does not matter") {
    const Design design = adaptive(2, 16, 128);
    Refinement one(design), other(design);
    for (auto points = one.next(); !points.empty(); points = one.next()) {
        auto reversed = other.next();
        REQUIRE(reversed.size() == points.size());
        std::ranges::reverse(reversed);
        for (const Point& point : points)
            one.learn(result_of(circle(0.6), point));
        for (const Point& point : reversed)
            other.learn(result_of(circle(0.6), point));
    }
    CHECK(other.next().empty());
    CHECK(one.leaves().size() == other.leaves().size());
}

TEST_CASE("An observable that changes by more than its step divides cells") {
    Design design = adaptive(2, 4, 256);
    design.drivers = {{0, 0.1}}; // of x + y, which changes by 4/N over a cell of N a side
    const auto one = [](const At&) { return 0; };
    const Refinement refinement = refined(design, one);
    const auto leaves = refinement.leaves();
    for (const Leaf& leaf : leaves) {
        const auto high = [&](std::size_t k) { return leaf.low[k] + leaf.side; };
        const At low_at = refinement.lattice().point(leaf.low).at,
                 high_at = refinement.lattice().point({high(0), high(1), 0}).at;
        CHECK(high_at[0] + high_at[1] - low_at[0] - low_at[1] <= 0.1);
    }
    CHECK(leaves.size() == 64 * 64); // 4/64 = 0.0625; 4/32 is too much
    CHECK(wrong_places(refinement.lattice(), leaves, one) == 0);
}

TEST_CASE("A strip that passes between all places of the start is found by what changes sign over it") {
    const Map thin = strip(0.3, 1.0, 0.1015625, 0.0021); // a fifteenth of a cell of the start
    Design design = adaptive(2, 64, 1024);
    const Refinement blind = refined(design, thin);
    design.side = [](const Result& result) {
        return 0.3 * result.point.at[0] + result.point.at[1] - 0.1015625;
    };
    const Refinement led = refined(design, thin);
    CHECK(wrong_places(blind.lattice(), blind.leaves(), thin) > 100);
    CHECK(wrong_places(led.lattice(), led.leaves(), thin) == 0);
    design.side = [](const Result&) { return std::nan(""); };
    const Refinement unled = refined(design, thin);
    CHECK(unled.leaves().size() == blind.leaves().size());
}

TEST_CASE("Cells that only an observable divides keep their outcome") {
    Design design = adaptive(2, 4, 8);
    design.drivers = {{0, 1e-3}}; // never reached
    const Refinement refinement = refined(design, [](const At&) { return 1; });
    const auto is_plain = [](const Leaf& leaf) { return !leaf.mixed && leaf.outcome == 1; };
    CHECK(std::ranges::all_of(refinement.leaves(), is_plain));
}

TEST_CASE("An observable that is not there drives nothing, and a failure divides") {
    Design design = adaptive(2, 4, 64);
    design.drivers = {{1, 1e6}};
    const auto failing = [](const At& at) { return at[0] < 0.3 ? 0 : -1; };
    const Refinement refinement = refined(design, failing);
    CHECK(wrong_places(refinement.lattice(), refinement.leaves(), failing) == 0);
}

TEST_CASE("The leaf at a place holds it") {
    const Refinement refinement = refined(adaptive(2, 16, 256), circle(0.6));
    const Lattice& lattice = refinement.lattice();
    const std::int64_t fine = lattice.stride(lattice.levels());
    for (std::int64_t i = 0; i <= 256; i += 3)
        for (std::int64_t j = 0; j <= 256; j += 5) {
            const Lattice::LatticePoint place{i * fine, j * fine, 0};
            const Leaf leaf = refinement.leaf_at(place);
            for (const std::size_t k : {0, 1}) {
                CHECK(leaf.low[k] <= place[k]);
                CHECK(place[k] <= leaf.low[k] + leaf.side);
            }
        }
}

TEST_CASE("A place where something was found is divided to the finest, with what follows") {
    const Map island = circle(0.02, 0.53, -0.41);
    Refinement refinement = refined(adaptive(2, 16, 512), island);
    REQUIRE(wrong_places(refinement.lattice(), refinement.leaves(), island) > 0); // missed
    const Lattice& lattice = refinement.lattice();
    const std::int64_t fine = lattice.stride(lattice.levels());
    // 0.53 = -1 + 2 u: cell 391.7 of 512, and 151.04
    const Lattice::LatticePoint found{392 * fine, 151 * fine, 0};
    REQUIRE(island(lattice.point(found).at) == 0);
    refinement.learn(result_of(island, lattice.point(found)));
    refinement.divide_at(found);
    for (auto points = refinement.next(); !points.empty(); points = refinement.next())
        for (const Point& point : points)
            refinement.learn(result_of(island, point));
    CHECK(wrong_places(lattice, refinement.leaves(), island) == 0);
    CHECK_FALSE(tiling(lattice, refinement.leaves()).empty());
    CHECK(is_balanced(lattice, refinement.leaves()));
}
