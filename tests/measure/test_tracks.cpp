// Tracks put in order, windows, and measures in them: truths known by hand, and those of a periodic box.

#include "rodwake/measure/tracks.hpp"

#include "measure/pair_counts.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/displacement.hpp"
#include "rodwake/measure/flow.hpp"
#include "rodwake/measure/heading_diffusion.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/order.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <random>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Share of directions in which a point at this distance is inside, by trying them.
double share_by_trying(const Window& window, double x, double y, double r) {
    constexpr int directions = 40000;
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

OrderResult order_of(const Tracks& tracks, double block = 5.0) {
    OrderOptions options;
    options.block = block;
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
                      .margin(2.5e-4));
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
}

TEST_CASE("Frames without rows do not exist, and any rising steps or times are taken") {
    TrackRows times = rows_of({{0, 1, 1.0, 1.0}, {0, 1, 1.0, 2.0}, {0, 1, 1.0, 3.0}});
    times.frame.clear();
    times.time = {0.1, 0.2001, 0.3}; // of a film, rounded
    CHECK(ordered_tracks(times, window_of(10.0), "f").time[1] == Approx(0.2));
    times.time = {0.0, 0.1, 0.25};
    CHECK(ordered_tracks(times, window_of(10.0), "f").time == times.time);
    CHECK_FALSE(ordered_tracks(times, window_of(10.0), "f").on_grid);
    times.time = {3.0, 3.0 + 1e-15, 4.0}; // one frame, but for rounding
    CHECK(ordered_tracks(times, window_of(10.0), "f").frames() == 2);
    constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min() + 7;
    const Tracks far = ordered_tracks(rows_of({{least, 1, 1.0, 1.0}, {least + 1'000'000'000, 1, 1.0, 1.0}}),
                                      window_of(10.0), "f");
    CHECK(far.has_all_frames());
    CHECK(far.time.back() == 5e8);
    const TrackScale scale{1.0, 10.0, 0.5, {}, {}};
    const std::vector<Row> all = bound_beads(400);
    const MicrorheologyResult whole = msd_of(ordered_tracks(rows_of(all), scale, "f"));
    const auto of = [&](const auto& exists) {
        std::vector<Row> rows = all;
        std::erase_if(rows, [&](const Row& row) { return !exists(row.frame); });
        return ordered_tracks(rows_of(rows), scale, "f");
    };
    const Tracks bursts = of([](std::int64_t f) { return f % 30 < 10; }),
                 log_spaced =
                     of([](std::int64_t f) { return f < 2 || std::has_single_bit(std::uint64_t(f)); }),
                 late = of([](std::int64_t f) { return f == 0 || f % 20 == 7; });
    CHECK(bursts.on_grid);
    CHECK(bursts.beads_per_frame() == 700.0);
    CHECK(bursts.lost_share() == 0.0);
    CHECK_FALSE(log_spaced.on_grid);
    CHECK_FALSE(late.on_grid);
    for (const Tracks* film : {&bursts, &log_spaced, &late}) {
        const MicrorheologyResult found = msd_of(*film);
        INFO(film->frames());
        CHECK(found.lag.size() >= 8);
        for (std::size_t k = 0; k < found.lag.size(); ++k)
            if (const double steps = 10.0 * found.lag[k]; steps < 200.0 && found.origins[k] > 3.0) {
                INFO(steps);
                const std::size_t at =
                    std::ranges::lower_bound(whole.lag, found.lag[k] * (1.0 - 1e-9)) - whole.lag.begin();
                const double expected = whole.msd[at]; // the next longer lag that it has
                CHECK(found.msd[k] == Approx(expected).epsilon(steps < 16.5 ? 0.08 : 0.15));
                CHECK(found.msd_error[k] > 0.0);
            }
    }
    CHECK_THAT(msd_of(log_spaced).no_stiffness, Catch::Contains("needs at least 32"));
    CHECK(msd_of(log_spaced).stiffness_zero.count == 0);
    CHECK(msd_of(of([](std::int64_t f) { return f % 13 < 5 && f % 11 > 3; })).stiffness_zero.value ==
          Approx(whole.stiffness_zero.value).epsilon(0.25));
    CHECK_THROWS_WITH(
        msd_of(ordered_tracks(rows_of({{0, 1, 1.0, 1.0}, {1, 2, 2.0, 1.0}}), window_of(10.0), "f")),
        Catch::Contains("needs at least 16"));
}

TEST_CASE("Certain ids are never cut, those of a camera where they jump; image indices say the way") {
    // Three steps of 8 in a box of 20: the shortest way back is 12, and from one to the next 8.
    TrackRows rows = rows_of({{0, 1, 1.0, 1.0}, {1, 1, 9.0, 1.0}, {2, 1, 17.0, 1.0}, {3, 1, 25.0, -1.0}});
    for (int k = 0; k < 48; ++k) { // others
        rows.frame.push_back(k % 4);
        rows.id.push_back(10 + k / 4);
        rows.x.push_back(0.5 + k % 12);
        rows.y.push_back(3.0 + k % 4);
    }
    TrackScale scale{1.0, 1.0, 0.5, {}, Window::rectangle(-1.0, -3.0, 26.0, 7.0)};
    scale.longest_step = 7.9;
    const auto cuts = [&] { return ordered_tracks(rows, scale, "f").counts.restarts; };
    CHECK(cuts() == 3);
    scale.longest_step = HUGE_VAL;
    CHECK(cuts() == 0);
    scale.longest_step.reset();
    CHECK(cuts() == 0); // 8 is less than three spacings of 4.9
    std::swap(rows.x[1], rows.x[3]);
    CHECK(cuts() > 0);
    CHECK(ordered_tracks(rows, scale, "f").cut_rule.find("tracks.longest_step") != std::string::npos);
    rows.certain_ids = true;
    CHECK(cuts() == 0);
    std::swap(rows.x[1], rows.x[3]);
    rows.certain_ids = false;
    scale = {1.0, 1.0, 0.5, PeriodicBox(20.0), {}};
    CHECK(cuts() == 0);
    rows.image_x.assign(rows.size(), 0);
    rows.image_y.assign(rows.size(), 0);
    rows.image_x[2] = 1;                  // 17 + 20
    rows.x[3] += 20.0, rows.y[3] += 20.0; // 45, 19: the same, as a file that does not wrap has it
    rows.image_y[3] = -1;
    rows.is_rod.assign(rows.size(), 0);
    for (const bool rod : {false, true}) {
        rows.is_rod[0] = rows.is_rod[1] = rows.is_rod[2] = rows.is_rod[3] = rod;
        const Tracks t = ordered_tracks(rows, scale, "f");
        std::vector<double> x, y;
        for_each_frame(t, 1, [&](const Frame& frame, double) {
            CHECK((rod || frame.x[0] < 20.0));
            x.push_back(rod ? frame.rods[0].x : frame.unwrapped_x[0]);
            y.push_back(rod ? frame.rods[0].y : frame.unwrapped_y[0]);
            return true;
        });
        CHECK(x == std::vector<double>{1.0, 9.0, 37.0, 45.0});
        CHECK(y == std::vector<double>{1.0, 1.0, 1.0, -1.0});
        CHECK(t.beads == (rod ? 12 : 13));
        if (rod)
            CHECK(poses_of(t, 0).x == x);
    }
}

TEST_CASE("A spot far off and a wrong unit are reported; no grid grows with the emptiness") {
    std::vector<Row> rows = bound_beads(3);
    std::erase_if(rows, [](const Row& row) { return row.id >= 112; });
    rows[150].y = 1e7;
    TrackScale scale{1.0, 10.0, 0.5, {}, {}};
    for (const double x : {rows[150].x, -2e7}) { // a long window, and a wide one
        rows[150].x = x;
        const Tracks t = ordered_tracks(rows_of(rows), scale, "f");
        REQUIRE(t.warnings.size() == 2);
        CHECK_THAT(t.warnings[0],
                   Catch::Contains("f: frame 1: a spot at (") && Catch::Contains("1e+07) of the file"));
        CHECK_THAT(t.warnings[1], Catch::Contains("is tracks.pixel or tracks.bead_radius right?"));
        const OrderResult order = order_of(t);
        CHECK(order.g.size() < 10'000);
        CHECK(order.psi6.value > 0.5);
    }
    scale.window = Window::rectangle(0.0, 0.0, 30.0, 30.0);
    rows[150].y = 29.0;
    CHECK(ordered_tracks(rows_of(rows), scale, "f").warnings.empty());
    scale.bead_radius = 0.05; // 112 of them cover 1e-3
    scale.pixel = 10.0;
    scale.window = Window::rectangle(0.0, 0.0, 300.0, 300.0);
    CHECK(ordered_tracks(rows_of(rows), scale, "f").warnings.size() == 1);
}

TEST_CASE("Every measure takes a film with frames of no, one or untracked beads, or says what is missing") {
    const auto measured = [](const std::vector<Row>& beads, std::size_t rod_frames) {
        TrackRows rows = rows_of(beads);
        rows.is_rod.assign(rows.size(), 0);
        rows.heading.assign(rows.size(), std::nan(""));
        for (std::size_t f = 0; f < rod_frames; ++f) {
            rows.frame.push_back(static_cast<std::int64_t>(f));
            rows.id.push_back(1);
            rows.x.push_back(8.0 + 0.1 * static_cast<double>(f));
            rows.y.push_back(12.0);
            rows.is_rod.push_back(1);
            rows.heading.push_back(0.0);
        }
        std::string said;
        for (const bool periodic : {false, true}) {
            TrackScale scale{1.0, 10.0, 0.5, {}, {}};
            if (periodic)
                scale.box = PeriodicBox(30.0);
            const auto run = [&](const auto& use) {
                try {
                    use(ordered_tracks(rows, scale, "f"));
                } catch (const InputError& error) {
                    said += std::string(error.what()) + "\n";
                }
            };
            run([](const Tracks& t) { order_of(t); });
            run([](const Tracks& t) { msd_of(t); });
            run([](const Tracks& t) {
                const auto sums = sums_of<FlowAccumulator>(t, FlowOptions{0, 2.0, 0.1, 5.0, 4.0, 0.0});
                reduce(std::span(&sums, 1));
            });
            for (const auto method : {DisplacementMethod::phase, DisplacementMethod::lagrangian})
                run([&](const Tracks& t) {
                    DisplacementOptions options;
                    options.method = method;
                    options.spacing = 2.0;
                    const auto sums = sums_of<DisplacementAccumulator>(t, options);
                    reduce(std::span(&sums, 1));
                });
            run([](const Tracks& t) {
                const std::vector<HeadingTrack> poses{poses_of(t, 0)};
                heading_diffusion(poses, {1.0, 0.1, 0.5});
            });
        }
        return said;
    };
    const TrackScale hull{1.0, 10.0, 0.5, {}, {}};
    for (const std::size_t frames :
         {2, 3}) { // blocks of one frame each: two have a difference, but no scatter
        const OrderResult order = order_of(ordered_tracks(rows_of(bound_beads(frames)), hull, "f"), 0.1);
        CHECK(order.psi6.known() == (frames == 3));
        CHECK(order.neighbours.known() == (frames == 3));
    }
    std::vector<Row> film = bound_beads(3);
    CHECK(measured(film, 4).find("order") == std::string::npos); // a rod in a frame without beads
    std::erase_if(film, [](const Row& row) { return row.frame == 1 && row.id > 300; });
    measured(film, 6);
    std::erase_if(film, [](const Row& row) { return row.frame == 1 && row.id > 0; }); // one bead
    measured(film, 3);
    for (Row& row : film)
        row.id = no_track;
    CHECK_THAT(measured(film, 3), Catch::Contains("no bead is in two frames"));
    measured({{0, 1, 1.0, 1.0}, {0, 2, 5.0, 1.0}, {0, 3, 1.0, 7.0}}, 2);
    measured({}, 40);
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
