// Grids around rods, places as rods see them, and frames that do not fit.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/measure/rod_grid.hpp"
#include "synthetic.hpp"

#include <cmath>
#include <limits>
#include <numbers>

using namespace rodwake;
using namespace rodwake::measure;

namespace {
const double a = 4e-4, box = 78.0 * a;
const double none = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
} // namespace

TEST_CASE("a grid has an even number of bins, as near the wanted spacing as can be", "[rod_grid]") {
    for (const double wanted : {0.5 * a, 1.0 * a, 2.0 * a, 2.1 * a, 5.0 * a, 19.5 * a}) {
        const RodGrid grid(box, wanted);
        CHECK(grid.columns % 2 == 0);
        CHECK(grid.columns >= 4);
        CHECK(grid.width * static_cast<double>(grid.columns) == Approx(box).epsilon(1e-15));
        for (const std::size_t other : {grid.columns - 2, grid.columns + 2}) // n is nearest to L/wanted
            if (other >= 4)
                CHECK(std::abs(box / wanted - static_cast<double>(grid.columns)) <=
                      std::abs(box / wanted - static_cast<double>(other)) + 1e-9);
        CHECK(grid.x(grid.columns / 2) == 0.0);
        CHECK(grid.x(0) == Approx(-box / 2.0).epsilon(1e-15));
    }
    for (const double wanted : {0.0, -a, box / 3.9, none, inf, 1e-300})
        CHECK_THROWS_AS(RodGrid(box, wanted), InputError);
    CHECK_THROWS_AS(RodGrid(0.0, a), InputError);
    CHECK_THROWS_AS(RodGrid(none, a), InputError);
    CHECK_THROWS_AS(RodGrid(inf, a), InputError);
    CHECK(RodGrid().bins() == 0);
    CHECK_FALSE(RodGrid().bin(0.0, 0.0));
}

TEST_CASE("middles are in their bins, far edges belong to the image, and outside is nowhere", "[rod_grid]") {
    const RodGrid grid(box, 2.0 * a);
    for (std::size_t j = 0; j < grid.rows; ++j)
        for (std::size_t i = 0; i < grid.columns; ++i)
            for (const double off : {-0.49, 0.0, 0.49})
                CHECK(grid.bin(grid.x(i) + off * grid.width, grid.y(j) - off * grid.width) ==
                      j * grid.columns + i);
    CHECK(grid.bin(box / 2.0 - 0.51 * grid.width, 0.0) == grid.columns / 2 * grid.columns + grid.columns - 1);
    CHECK(grid.bin(box / 2.0 - 0.49 * grid.width, 0.0) == grid.columns / 2 * grid.columns);
    CHECK(grid.bin(0.0, box / 2.0) == grid.columns / 2);
    for (const double out :
         {box / 2.0 + 0.51 * grid.width, -box / 2.0 - 0.51 * grid.width, inf, none, 1e300}) {
        CHECK_FALSE(grid.bin(out, 0.0));
        CHECK_FALSE(grid.bin(0.0, out));
    }
}

TEST_CASE("what a rod sees comes back to where it is", "[rod_grid]") {
    RandomStream random(4);
    for (int k = 0; k < 1000; ++k) {
        const RodPosition rod = {random.uniform(-3.0 * box, 3.0 * box), random.uniform(-3.0 * box, 3.0 * box),
                                 random.uniform(-3.14, 3.14)};
        const double x = random.uniform(0.0, box), y = random.uniform(0.0, box);
        const RelativePosition seen = relative_position(rod, x, y, box);
        const double c = std::cos(rod.heading), s = std::sin(rod.heading);
        // places of 1e-1 m: round-off 1e-16
        CHECK(nearest_image(rod.x + c * seen.x - s * seen.y - x, box) == Approx(0.0).margin(1e-15));
        CHECK(nearest_image(rod.y + s * seen.x + c * seen.y - y, box) == Approx(0.0).margin(1e-15));
        CHECK(std::hypot(seen.x, seen.y) <= box / std::sqrt(2.0) * (1.0 + 1e-12));
    }
    const RelativePosition ahead =
        relative_position({1.0 * a, 2.0 * a, std::numbers::pi / 2.0}, 1.0 * a, 5.0 * a, box);
    CHECK(ahead.x == Approx(3.0 * a).epsilon(1e-12)); // above a rod that heads up: ahead
    CHECK(ahead.y == Approx(0.0).margin(1e-15));
    const RelativePosition left =
        relative_position({1.0 * a, 2.0 * a, std::numbers::pi / 2.0}, 77.0 * a, 2.0 * a, box);
    CHECK(left.y == Approx(2.0 * a).epsilon(1e-12)); // across the boundary, to its left
}

TEST_CASE("layouts and frames that do not fit are refused", "[frame]") {
    const Layout good = synthetic::layout(3, 1);
    CHECK_NOTHROW(validate(good));
    for (const double bad : {0.0, -1.0, none, inf}) {
        const auto refused = [&](auto change) {
            Layout layout = good;
            change(layout);
            CHECK_THROWS_AS(validate(layout), InputError);
        };
        refused([&](Layout& layout) { layout.box.x = bad; });
        refused([&](Layout& layout) { layout.box.y = bad; });
        refused([&](Layout& layout) { layout.bead_radius = bad; });
        refused([&](Layout& layout) { layout.bead_mass = bad; });
    }
    Layout small = good;
    small.box = 7.9 * small.bead_radius;
    CHECK_THROWS_AS(validate(small), InputError);
    CHECK_THROWS_AS(validate(synthetic::layout(0)), InputError);

    const Frame frame = synthetic::frame_of(good, 0.0, {a, -a, 90.0 * a}, {0.0, 0.0, a}, {{a, a, 0.1}});
    CHECK_NOTHROW(check_frame(good, frame));
    for (std::vector<double> Frame::*row :
         {&Frame::x, &Frame::y, &Frame::unwrapped_x, &Frame::unwrapped_y, &Frame::vx, &Frame::vy}) {
        Frame bad = frame;
        (bad.*row).pop_back();
        CHECK_THROWS_AS(check_frame(good, bad), RunError);
        bad = frame;
        (bad.*row)[1] = none;
        CHECK_THROWS_AS(check_frame(good, bad), RunError);
    }
    for (const double out : {-1e-18, good.box.y}) {
        Frame bad = frame;
        bad.y[2] = out;
        CHECK_THROWS_AS(check_frame(good, bad), RunError);
    }
    Frame bad = frame;
    bad.time = none;
    CHECK_THROWS_AS(check_frame(good, bad), RunError);
    bad = frame;
    bad.rods[0].heading = inf;
    CHECK_THROWS_AS(check_frame(good, bad), RunError);
    bad.rods.clear();
    CHECK_THROWS_AS(check_frame(good, bad), RunError);
}

TEST_CASE("differences are taken to the nearest image", "[frame]") {
    CHECK(nearest_image(0.6, 1.0) == Approx(-0.4).epsilon(1e-15));
    CHECK(nearest_image(-7.4, 1.0) == Approx(-0.4).epsilon(1e-14));
    CHECK(std::abs(nearest_image(0.5, 1.0)) == 0.5);
}

TEST_CASE("synthetic frames are whole", "[frame]") {
    CHECK(synthetic::wrapped(-0.25, 1.0) == 0.75);
    CHECK(synthetic::wrapped(-1e-18, 1.0) == 0.0);
    CHECK(synthetic::wrapped(7.5, 1.0) == 0.5);
    synthetic::Normal normal(1);
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < 20000; ++k) {
        const double value = normal();
        sum += value;
        squares += value * value;
    }
    CHECK(sum / 20000 == Approx(0.0).margin(4.0 / std::sqrt(20000.0)));
    CHECK(squares / 20000 == Approx(1.0).margin(4.0 * std::sqrt(2.0 / 20000.0)));
}
