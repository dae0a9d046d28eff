// Tracks put in order, windows, and measures in them: truths known by hand, and those of a periodic box.

#include "rodwake/measure/tracks.hpp"

#include "measure/pair_counts.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/order.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Share of directions in which a point at this distance is inside, by trying them.
double share_by_trying(const Window& window, double x, double y, double r) {
    constexpr int directions = 200000;
    int inside = 0;
    for (int k = 0; k < directions; ++k) {
        const double angle = 2.0 * pi * (k + 0.5) / directions;
        inside += window.inside_by(x + r * std::cos(angle), y + r * std::sin(angle)) >= 0.0;
    }
    return inside / static_cast<double>(directions);
}

struct Row {
    std::int64_t frame, id;
    double x, y;
};

TrackRows rows_of(const std::vector<Row>& list) {
    TrackRows rows;
    for (const Row& row : list) {
        rows.frame.push_back(row.frame);
        rows.id.push_back(row.id);
        rows.x.push_back(row.x);
        rows.y.push_back(row.y);
    }
    return rows;
}

TrackScale window_of(double side) { return {1.0, 2.0, 0.5, {}, Window::rectangle(0.0, 0.0, side, side)}; }

/// Random walks of beads bound to a triangular lattice that drifts, in a square of side 30 with a = 0.5.
std::vector<Row> bound_beads(std::size_t frames) {
    constexpr double spacing = 1.2, kick = 0.03, pull = 0.2, drift = 0.002;
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::vector<Row> sites, rows;
    for (int j = 0; j < 28; ++j)
        for (int i = 0; i < 25; ++i)
            sites.push_back({0, j * 25 + i, spacing * (i + 0.5 * (j % 2)), spacing * 0.866 * j});
    std::vector<double> u(2 * sites.size(), 0.0);
    for (std::size_t f = 0; f < frames; ++f)
        for (std::size_t k = 0; k < sites.size(); ++k) {
            for (const std::size_t c : {2 * k, 2 * k + 1})
                u[c] += -pull * u[c] + kick * normal(random);
            rows.push_back({static_cast<std::int64_t>(f), sites[k].id,
                            sites[k].x + u[2 * k] + drift * static_cast<double>(f),
                            sites[k].y + u[2 * k + 1]});
        }
    return rows;
}

template<class Sums, class Options>
Sums sums_of(const Tracks& tracks, const Options& options) {
    Sums sums(layout_of(tracks), options);
    for_each_frame(tracks, 1, [&](const Frame& frame, double) {
        sums.add(frame);
        return true;
    });
    return sums;
}

MicrorheologyResult msd_of(const Tracks& tracks) {
    const auto sums = sums_of<MicrorheologyAccumulator>(tracks, MicrorheologyOptions{});
    return reduce(std::span(&sums, 1));
}

OrderResult order_of(const Tracks& tracks) {
    OrderOptions options;
    options.bin = 0.025;
    options.order_bin = 0.5;
    const auto sums = sums_of<OrderAccumulator>(tracks, options);
    return reduce(std::span(&sums, 1));
}

} // namespace

TEST_CASE("The share of a circle inside a window is exact") {
    std::vector<double> hull_x{0.0, 4.0, 7.0, 3.0, -1.0, 2.0}, hull_y{0.0, -1.0, 2.0, 6.0, 3.0, 2.0};
    const struct {
        Window window;
        double x, y;
    } cases[] = {
        {Window::rectangle(0.0, 0.0, 5.0, 3.0), 1.0, 0.7}, {Window::rectangle(0.0, 0.0, 5.0, 3.0), 2.5, 1.5},
        {Window::rectangle(0.0, 0.0, 5.0, 3.0), 5.0, 3.0}, // in a corner
        {Window::rectangle(0.0, 0.0, 5.0, 3.0), 0.0, 0.5}, // on the border
        {Window::circle(1.0, 2.0, 3.0), 2.0, 3.5},         {Window::circle(1.0, 2.0, 3.0), 1.0, 2.0},
        {Window::hull(hull_x, hull_y), 3.0, 1.0},          {Window::hull(hull_x, hull_y), 6.0, 1.6}};
    for (const auto& one : cases) {
        std::vector<double> share(9);
        measure::CircleShares(one.window).about(one.x, one.y, 0.8, share);
        for (std::size_t k = 0; k < share.size(); ++k) {
            INFO(k);
            // a direction of those tried at each of at most 10 crossings
            CHECK(share[k] ==
                  Approx(share_by_trying(one.window, one.x, one.y, (static_cast<double>(k) + 0.5) * 0.8))
                      .margin(5e-5));
        }
    }
}

TEST_CASE("The convex hull holds all points, and its area is that of the corners") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    std::vector<double> x{0.0, 2.0, 2.0, 0.0}, y{0.0, 0.0, 1.0, 1.0};
    for (int k = 0; k < 5000; ++k) {
        x.push_back(2.0 * place(random));
        y.push_back(place(random));
    }
    const Window window = Window::hull(x, y);
    CHECK(window.corners.size() == 4);
    CHECK(window.area() == Approx(2.0).epsilon(1e-15));
    CHECK_THROWS_AS(Window::hull(std::vector{0.0, 1.0, 2.0}, std::vector{0.0, 1.0, 2.0}), InputError);
}

TEST_CASE("Tracks: gaps, repeated rows, restarts, frames out of order, spots outside and of no track") {
    const Tracks t = ordered_tracks(rows_of({{14, 1, 3.0, 3.0},
                                             {10, 1, 1.0, 1.0},
                                             {10, 2, 5.0, 5.0},
                                             {12, 2, 5.1, 5.0},
                                             {10, 1, 9.0, 9.0},
                                             {16, 1, 3.1, 3.0},
                                             {12, 3, 11.0, 5.0},
                                             {12, no_track, 7.0, 7.0},
                                             {18, 1, 8.0, 8.0},
                                             {16, 3, 6.0, 6.0}}),
                                    window_of(10.0), "f");
    CHECK(t.time == std::vector<double>{0.0, 1.0, 2.0, 3.0, 4.0}); // every second frame, two a second
    CHECK(t.counts.rows == 10);
    CHECK(t.counts.repeated == 1);
    CHECK(t.counts.outside == 1);
    CHECK(t.counts.untracked == 1);
    CHECK(t.counts.restarts == 0);
    CHECK(t.beads == 3);
    CHECK(t.bead == std::vector<std::uint32_t>{0, 1, 1, untracked, 0, 0, 2, 0});
    CHECK(t.counts.missing == 1); // of number 1 in frame 12
    CHECK(t.mean_length() == Approx(8.0 / 3.0));
    CHECK(layout_of(t).all_beads == 3);
    // Beads 2.7 apart on average: after a gap number 4 goes on so far away that it must be another.
    std::vector<Row> many;
    for (int f = 0; f < 4; ++f)
        for (int k = 0; k < 16; ++k)
            many.push_back({f, k, 1.0 + 2.0 * (k % 4), 1.0 + 2.0 * (k / 4)});
    many.erase(std::ranges::find_if(many, [](const Row& row) { return row.frame == 1 && row.id == 4; }));
    many[many.size() - 12].x += 4.0;
    const Tracks cut = ordered_tracks(rows_of(many), window_of(10.0), "f");
    CHECK(cut.counts.restarts == 0); // 4 in one frame is within three spacings
    for (Row& row : many)
        row.x += row.id == 4 && row.frame > 1 ? 4.0 : 0.0;
    CHECK(ordered_tracks(rows_of(many), window_of(10.0), "f").counts.restarts == 1);
}

TEST_CASE("Tracks that are no film are refused") {
    CHECK_THROWS_WITH(ordered_tracks(rows_of({{3, 1, 1.0, 1.0}, {3, 2, 2.0, 1.0}}), window_of(10.0), "f"),
                      "f: all rows are of frame 3: tracks need at least two frames");
    CHECK_THROWS_WITH(ordered_tracks(rows_of({{0, 1, 11.0, 1.0}, {1, 2, 12.0, 1.0}}), window_of(10.0), "f"),
                      Catch::Contains("no bead lies in the window: 2 rows are outside"));
    CHECK_THROWS_WITH(
        ordered_tracks(rows_of({{0, 1, 1.0, 1.0}, {100'000'000'001, 2, 2.0, 1.0}, {1, 2, 2.0, 1.0}}),
                       window_of(10.0), "f"),
        Catch::Contains("is the right column named in tracks.columns?"));
    TrackRows times = rows_of({{0, 1, 1.0, 1.0}, {0, 1, 1.0, 2.0}, {0, 1, 1.0, 3.0}});
    times.frame.clear();
    times.time = {0.0, 0.1, 0.25};
    CHECK_THROWS_WITH(ordered_tracks(times, window_of(10.0), "f"), Catch::Contains("evenly spaced"));
    times.time = {0.1, 0.2001, 0.3}; // of a film, rounded
    CHECK(ordered_tracks(times, window_of(10.0), "f").time[1] == Approx(0.2));
}

TEST_CASE("An ideal gas has g = 1 up to half a window") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    constexpr double side = 20.0, bin = 0.5;
    constexpr std::size_t bins = 20, frames = 200, beads = 200;
    for (const Window& window : {Window::rectangle(0.0, 0.0, side, side), Window::circle(10.0, 10.0, 10.0)}) {
        std::vector<double> sums(bins, 0.0);
        double pairs = 0.0;
        for (std::size_t f = 0; f < frames; ++f) {
            std::vector<double> x, y;
            while (x.size() < beads) {
                const double at_x = side * place(random), at_y = side * place(random);
                if (window.inside_by(at_x, at_y) < 0.0)
                    continue;
                x.push_back(at_x);
                y.push_back(at_y);
            }
            const auto found = count_pairs_in(window, x, y, {side, side}, bin, bins);
            for (std::size_t k = 0; k < bins; ++k)
                sums[k] += found[k];
            pairs += 0.5 * beads * (beads - 1.0);
        }
        for (std::size_t k = 0; k < bins; ++k) {
            const double expected =
                pairs * pi * bin * bin * (2.0 * static_cast<double>(k) + 1.0) / window.area();
            INFO(k);
            // five standard errors of as many pairs; their weights make them at most twice as large
            CHECK(sums[k] / expected == Approx(1.0).margin(10.0 / std::sqrt(expected)));
        }
    }
}

TEST_CASE("Beads that come and go have the same order and displacement as those that stay") {
    const std::vector<Row> all = bound_beads(200);
    std::vector<Row> some;
    std::mt19937 random(5);
    for (Row row : all) {
        if (random() % 10 == 0) // a tenth of the spots lost
            continue;
        if (row.frame >= 100 && row.id % 3 == 0) // and a third of the numbers change half way
            row.id += 1000;
        some.push_back(row);
    }
    TrackScale scale{1.0, 10.0, 0.5, {}, {}};
    const Tracks whole = ordered_tracks(rows_of(all), scale, "f"),
                 gaps = ordered_tracks(rows_of(some), scale, "f");
    CHECK(layout_of(whole).all_beads == 0);
    CHECK(gaps.beads == 700 + 234);
    CHECK(gaps.lost_share() == Approx(0.1).margin(0.005)); // 1/sqrt(14 000)
    const MicrorheologyResult a = msd_of(whole), b = msd_of(gaps);
    for (std::size_t k = 0; k < 12; ++k) {
        INFO(a.lag[k]);
        CHECK(b.lag[k] == a.lag[k]);
        CHECK(b.msd[k] == Approx(a.msd[k]).margin(4.0 * a.msd_error[k])); // of the same beads, most of them
        CHECK(b.origins[k] < a.origins[k]);
    }
    CHECK(b.stiffness_zero.value == Approx(a.stiffness_zero.value).epsilon(0.1)); // its error is 3 to 5 %
    const OrderResult whole_order = order_of(whole);
    CHECK(whole_order.psi6.value > 0.9);
    REQUIRE(whole_order.at_border);
    CHECK(*whole_order.at_border ==
          Approx(1.0 - std::pow(1.0 - 2.0 * whole_order.cutoff / 29.0, 2)).margin(0.05));
}

TEST_CASE("The drift of beads that come and go is taken off") {
    std::vector<Row> rows = bound_beads(64);
    std::erase_if(rows, [](const Row& row) { return (row.frame + row.id) % 7 == 0; });
    const TrackScale scale{1.0, 10.0, 0.5, {}, {}};
    const double still = msd_of(ordered_tracks(rows_of(rows), scale, "f")).msd.back();
    for (Row& row : rows)
        row.x += 0.05 * static_cast<double>(row.frame);
    CHECK(msd_of(ordered_tracks(rows_of(rows), scale, "f")).msd.back() == Approx(still).epsilon(1e-9));
}
