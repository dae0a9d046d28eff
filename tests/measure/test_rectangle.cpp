// Measures in boxes whose sides differ: crystals and gases against what they are, and fields around a rod
// against those of the same bed turned by 90 degrees.

#include "measure/pair_counts.hpp"
#include "measure/psi6.hpp"
#include "rodwake/measure/bragg.hpp"
#include "rodwake/measure/displacement.hpp"
#include "rodwake/measure/flow.hpp"
#include "rodwake/measure/order.hpp"
#include "synthetic.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::measure;
using namespace rodwake::measure::synthetic;

namespace {

using Row = std::vector<double>;
const double a = 4e-4;

struct Places {
    PeriodicBox box;
    Row x, y;
};

/// A perfect lattice in the rectangle that it fills, rows along x.
Places crystal(int in_row, int rows, double spacing) {
    Places p{{in_row * spacing, rows * spacing * std::sqrt(0.75)}, {}, {}};
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < in_row; ++i) {
            p.x.push_back((i + 0.5 * (j % 2) + 0.25) * spacing);
            p.y.push_back((j + 0.5) * spacing * std::sqrt(0.75));
        }
    return p;
}

Places gas(std::size_t beads, const PeriodicBox& box, std::uint64_t seed) {
    RandomStream random(seed);
    Places p{box, {}, {}};
    for (std::size_t i = 0; i < beads; ++i) {
        p.x.push_back(random.uniform(0.0, box.x));
        p.y.push_back(random.uniform(0.0, box.y));
    }
    return p;
}

/// A rod that walks through beads that step out of its way, 12 frames; `turned` by 90 degrees: (x, y) ->
/// (-y, x) in the box with sides exchanged.
std::vector<Frame> walk(Layout& layout, const Places& first, bool turned) {
    layout = {turned ? PeriodicBox(first.box.y, first.box.x) : first.box, a, 7.2e-7, first.x.size(), 1};
    layout.headings = {turned ? 0.5 * std::numbers::pi : 0.0};
    std::vector<Frame> frames;
    Places at = first;
    RodPosition rod{0.3 * first.box.x, 0.9 * first.box.y, 0.0};
    for (int k = 0; k < 12; ++k) {
        Row x = at.x, y = at.y;
        RodPosition seen = rod;
        if (turned) {
            for (std::size_t i = 0; i < x.size(); ++i) {
                x[i] = -at.y[i];
                y[i] = at.x[i];
            }
            seen = {-rod.y, rod.x, 0.5 * std::numbers::pi};
        }
        frames.push_back(frame_of(layout, 0.1 * k, x, y, {seen}));
        rod.x += 0.4 * a;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const RelativePosition from = relative_position(rod, at.x[i], at.y[i], first.box);
            const double g = std::exp(-(from.x * from.x + from.y * from.y) / (72.0 * a * a));
            at.x[i] += 0.2 * a * g;
            at.y[i] += 0.02 * a * g * from.y / a;
        }
    }
    return frames;
}

double furthest(const Row& one, const Row& two) {
    double worst = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i)
        worst = std::max(worst, std::abs(one[i] - two[i]));
    return worst;
}

} // namespace

TEST_CASE("a grid over a rectangle has bins of its own along each side", "[rectangle]") {
    const RodGrid grid({60.0, 42.5}, 1.0);
    CHECK(grid.columns == 60);
    CHECK(grid.rows == 42);
    CHECK(grid.height == Approx(42.5 / 42.0).epsilon(1e-15));
    for (std::size_t bin = 0; bin < grid.bins(); ++bin)
        CHECK(grid.bin(grid.x_of(bin) + 0.4, grid.y_of(bin) - 0.4) == bin);
    CHECK(grid.bin(0.0, 21.25) == grid.columns / 2); // the edge belongs to the image
    CHECK_FALSE(grid.bin(0.0, 22.0));
    Layout layout{{60.0, 42.5}, 1.0, 1.0, 100, 2};
    layout.headings = {0.2, 1.7};
    CHECK(box_seen_by(0, layout) == layout.box);
    CHECK(box_seen_by(1, layout) == PeriodicBox(42.5, 60.0));
}

TEST_CASE("a crystal in its own rectangle is perfect: six neighbours, psi_6 = 1, full peaks", "[rectangle]") {
    const Places p = crystal(14, 10, 2.1);
    for (const LocalOrder& order :
         {order_by_delaunay(p.x, p.y, p.box), order_by_cutoff(p.x, p.y, p.box, 1.4 * 2.1)}) {
        CHECK(std::ranges::all_of(order.neighbours, [](int n) { return n == 6; }));
        CHECK(order.global() == Approx(1.0).epsilon(1e-12));
    }
    const BraggPeaks peaks = find_peaks(p.x, p.y, p.box);
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(peaks.strength[k] == Approx(1.0).epsilon(1e-12));
        CHECK(std::hypot(peaks.G[k].x, peaks.G[k].y) ==
              Approx(4.0 * M_PI / std::sqrt(3.0) / 2.1).epsilon(1e-12));
    }
    CHECK(peaks.lattice_spacing() == Approx(2.1).epsilon(1e-12));
    CHECK(std::remainder(peaks.row_angle(), M_PI / 3.0) == Approx(0.0).margin(1e-12));
}

TEST_CASE("Delaunay neighbours in a long box are a triangulation of the torus", "[rectangle]") {
    for (const PeriodicBox box : {PeriodicBox(3.0, 1.0), PeriodicBox(0.4, 2.0)}) {
        const Places p = gas(60, box, 5);
        const auto bonds = delaunay_bonds(p.x, p.y, box);
        CHECK(bonds.size() == 6 * p.x.size()); // Euler: 3 N edges, each from either end
    }
}

TEST_CASE("pairs in a rectangle are counted as all pairs are, and a gas has g = 1", "[rectangle]") {
    const PeriodicBox box{60.0 * a, 33.0 * a};
    const double bin = 0.5 * a;
    const Places p = gas(800, box, 6);
    const std::size_t bins = whole_bins(box.shorter(), bin);
    Row counted(bins, 0.0);
    for (std::size_t i = 0; i < p.x.size(); ++i)
        for (std::size_t j = i + 1; j < p.x.size(); ++j)
            if (const auto k =
                    static_cast<std::size_t>(nearest_distance(p.x[i] - p.x[j], p.y[i] - p.y[j], box) / bin);
                k < bins)
                counted[k] += 1.0;
    const Row pairs = count_pairs(p.x, p.y, {}, box, bin, bins).pairs;
    CHECK(pairs == counted);
    const Row g = pair_correlation(pairs, 1.0, p.x.size(), box.area(), bin);
    double sum = 0.0, all = 0.0;
    for (std::size_t k = 0; k < bins; ++k) {
        sum += pairs[k];
        all += g[k] > 0.0 ? pairs[k] / g[k] : 0.0;
    }
    CHECK(sum / all == Approx(1.0).margin(5.0 / std::sqrt(sum))); // a Poisson number of pairs
}

TEST_CASE("fields around a rod turn with the bed and its box", "[rectangle]") {
    const Places first = gas(1500, {80 * a, 55 * a}, 7);
    Layout straight, turned;
    const auto one = walk(straight, first, false), other = walk(turned, first, true);
    const FlowOptions flow{0, 2.0 * a, 0.1, 5.0, 6.0 * a, 0.0};
    FlowAccumulator flow_one(straight, flow), flow_other(turned, flow);
    DisplacementOptions moved;
    moved.method = DisplacementMethod::lagrangian;
    moved.spacing = 2.0 * a;
    DisplacementAccumulator moved_one(straight, moved), moved_other(turned, moved);
    for (std::size_t k = 0; k < one.size(); ++k) {
        flow_one.add(one[k]);
        flow_other.add(other[k]);
        moved_one.add(one[k]);
        moved_other.add(other[k]);
    }
    const FlowField f = reduced(flow_one), g = reduced(flow_other);
    REQUIRE(f.grid == g.grid);
    CHECK(f.grid.columns == 40);
    CHECK(f.grid.rows == 28);
    CHECK(f.count == g.count);
    CHECK(furthest(f.vx, g.vx) < 1e-9 * a); // rounding of places of 80 a over 0.1 s
    CHECK(furthest(f.vy, g.vy) < 1e-9 * a);
    CHECK(*std::ranges::max_element(f.vx) > a);
    const DisplacementField u = reduced(moved_one), w = reduced(moved_other);
    REQUIRE(u.grid == w.grid);
    CHECK(furthest(u.count, w.count) < 1e-9 * *std::ranges::max_element(u.count));
    CHECK(furthest(u.Ux, w.Ux) < 1e-9 * a);
    CHECK(furthest(u.Uy, w.Uy) < 1e-9 * a);
    CHECK(*std::ranges::max_element(u.Ux) > 0.1 * a);
}
