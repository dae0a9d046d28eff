// Rods of tracks: axes and headings, gaps, numbers that are lost, and measures that bear with gaps.

#include "rodwake/measure/tracks.hpp"

#include "rodwake/measure/flow.hpp"
#include "rodwake/measure/heading_diffusion.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

constexpr double pi = 3.14159265358979323846, unknown = std::numeric_limits<double>::quiet_NaN();

/// Rods alone, in a square of side 100 with a = 1.
class Rows {
public:
    void add(std::int64_t frame, std::int64_t id, double x, double y, double heading) {
        rows_.frame.push_back(frame);
        rows_.id.push_back(id);
        rows_.x.push_back(x);
        rows_.y.push_back(y);
        rows_.heading.push_back(heading);
        rows_.is_rod.push_back(1);
    }
    Tracks tracks(bool ahead = false, bool periodic = false) const {
        TrackScale scale{1.0, 10.0, 1.0, {}, Window::rectangle(0.0, 0.0, 100.0, 100.0)};
        scale.thin_end_ahead = ahead;
        if (periodic)
            scale.box = PeriodicBox(100.0);
        return ordered_tracks(rows_, scale, "f");
    }

private:
    TrackRows rows_;
};

std::vector<std::size_t> frames_where(const std::vector<double>& values, bool known) {
    std::vector<std::size_t> found;
    for (std::size_t f = 0; f < values.size(); ++f)
        if (std::isnan(values[f]) != known)
            found.push_back(f);
    return found;
}

/// A rod that turns at random and goes at about 4 along its heading, with kicks; 10 rows a second.
HeadingTrack walk(std::size_t rows) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    HeadingTrack run{{0.0}, {0.0}, {0.0}, {0.3}};
    for (std::size_t i = 1; i < rows; ++i) {
        const double heading = run.heading.back() + 0.05 * normal(random), way = 0.4 + 0.5 * normal(random);
        run.time.push_back(0.1 * static_cast<double>(i));
        run.x.push_back(run.x.back() + way * std::cos(heading));
        run.y.push_back(run.y.back() + way * std::sin(heading));
        run.heading.push_back(heading);
    }
    return run;
}

} // namespace

TEST_CASE("the thin end is the one that goes ahead, through whole turns of the axis") {
    Rows rows;
    for (int f = 0; f < 60; ++f) { // once round a circle of radius 20, and the axis as an ellipse has it
        const double angle = 2.0 * pi * f / 60.0;
        double axis = std::fmod(angle + 0.5 * pi, pi);
        rows.add(f, 1, 50.0 + 20.0 * std::cos(angle), 50.0 + 20.0 * std::sin(angle), axis);
        rows.add(f, 2, 80.0 + 0.3 * std::cos(angle), 10.0, axis - pi); // goes nowhere
    }
    const Tracks t = rows.tracks(true);
    const HeadingTrack goes = poses_of(t, 0), stays = poses_of(t, 1);
    for (int f = 0; f < 60; ++f) {
        INFO(f);
        CHECK(goes.heading[static_cast<std::size_t>(f)] ==
              Approx(2.0 * pi * f / 60.0 + 0.5 * pi).margin(1e-12));
    }
    CHECK(frames_where(stays.heading, true).empty());
    CHECK(frames_where(stays.x, true).size() == 60);
    CHECK(t.counts.headless == 60);
    CHECK(poses_of(rows.tracks(false), 0).heading[30] == Approx(0.5 * pi).margin(1e-12)); // as given
}

TEST_CASE("gaps of a rod stay gaps, and one that comes again under another number is the same") {
    Rows rows;
    for (int f = 0; f < 40; ++f) {
        if (f < 10 || f > 12)
            rows.add(f, f < 10 ? 7 : 9, 96.0 + 0.5 * f, 50.0, f == 20 ? unknown : 0.0);
        rows.add(f, 3, 20.0, 20.0, 1.0);
    }
    const Tracks t = rows.tracks(false, true);
    REQUIRE(t.rods.size() == 2);
    CHECK(t.counts.joined == 1);
    const std::size_t moving = t.rods[0].number == 7 ? 0 : 1;
    const HeadingTrack poses = poses_of(t, moving);
    CHECK(frames_where(poses.x, false) == std::vector<std::size_t>{10, 11, 12});
    CHECK(frames_where(poses.heading, false) == std::vector<std::size_t>{10, 11, 12, 20});
    CHECK(poses.x[39] == Approx(96.0 + 0.5 * 39.0).epsilon(1e-14)); // over the side of the box
    std::size_t seen = 0;
    for_each_frame(t, 1, [&](const Frame& frame, double) {
        CHECK(frame.rods[moving].known() == poses.known(seen));
        CHECK(frame.rods[moving].seen() == !std::isnan(poses.x[seen]));
        if (frame.rods[moving].seen())
            CHECK(frame.rods[moving].x == poses.x[seen]);
        ++seen;
        return true;
    });
    Rows two; // both could be the one that is lost
    for (int f = 0; f < 20; ++f) {
        two.add(f, 1 + (f > 9 ? 10 : 0), 50.0 + 0.5 * f, 50.0, 0.0);
        if (f > 9)
            two.add(f, 12, 50.0 + 0.5 * f, 50.5, 0.0);
        two.add(f, 30, 5.0, 5.0, 0.0);
        two.add(f, 31, 95.0, 95.0, 0.0);
    }
    CHECK(two.tracks().rods.size() == 5);
    Rows pieces; // of one rod, so short that each could follow any before it
    for (int f = 0; f < 40; ++f)
        if (f % 8 < 5)
            pieces.add(f, f / 8, 40.0 + 0.5 * f, 50.0, 0.0);
    CHECK(pieces.tracks().rods.size() == 1);
    CHECK(pieces.tracks().counts.joined == 4);
}

TEST_CASE("heading diffusion bears with gaps") {
    const HeadingTrack whole = walk(6000);
    HeadingTrack gaps = whole;
    std::mt19937 random(5);
    for (std::size_t i = 1; i + 1 < gaps.time.size(); ++i)
        if (random() % 5 == 0)
            gaps.x[i] = gaps.y[i] = gaps.heading[i] = unknown;
    const HeadingOptions options{60.0, 1.0, 10.0};
    const auto a = heading_diffusion(std::span(&whole, 1), options),
               b = heading_diffusion(std::span(&gaps, 1), options);
    CHECK(a.diffusion.value == Approx(0.0125).margin(3.0 * a.diffusion.error));            // 0.05^2/(2 0.1)
    CHECK(b.diffusion.value == Approx(a.diffusion.value).margin(0.3 * a.diffusion.error)); // of the same walk
    CHECK(b.speed.value ==
          Approx(a.speed.value).epsilon(0.01)); // chords of two steps are shorter by (0.05)^2
    CHECK(b.origins[3] == Approx(0.64 * a.origins[3]).epsilon(0.05));
}

TEST_CASE("flow around a rod of beads that come and go, in a window") {
    Layout layout{{40.0, 40.0}, 1.0, 0.0, 300, 1};
    layout.headings = {0.5 * pi};
    layout.window = Window::rectangle(0.0, 0.0, 40.0, 40.0);
    layout.velocities = false;
    layout.all_beads = 400;
    const FlowOptions options{0, 4.0, 0.2, 5.0, 6.0, 0.0};
    FlowAccumulator flow(layout, options);
    std::mt19937 random(9);
    for (std::size_t f = 0; f < 50; ++f) {
        Frame frame;
        frame.time = 0.1 * static_cast<double>(f);
        frame.rods = {{20.0, 12.0 + 2.0 * frame.time, 0.5 * pi}};
        if (f % 7 == 3)
            frame.rods[0] = {unknown, unknown, unknown};
        for (std::uint32_t k = 0; k < 400; ++k) { // all drift; those right of the rod's path also go up at 1
            const double x = 2.0 * (k % 20) + 0.7 + 0.1 * frame.time, y0 = 2.0 * (k / 20) + 0.9,
                         y = y0 + (k % 20 >= 10 ? frame.time : -frame.time);
            if (random() % 10 == 0 || y < 0.0 || y > 40.0 || x > 40.0)
                continue;
            frame.x.push_back(x);
            frame.y.push_back(y);
            frame.bead.push_back(k);
        }
        frame.unwrapped_x = frame.x;
        frame.unwrapped_y = frame.y;
        flow.add(frame);
    }
    const FlowField field = reduce(std::span(&flow, 1));
    double right = 0.0, left = 0.0, outside = 0.0;
    for (std::size_t j = 0; j < field.grid.bins(); ++j) {
        const double x = field.grid.x_of(j), y = field.grid.y_of(j);
        outside += std::abs(x) > 26.0 || std::abs(y) > 26.0 ? field.count[j] : 0.0;
        if (field.count[j] > 0.0 && std::abs(x) < 9.0 && std::abs(y) > 4.0 && std::abs(y) < 12.0) {
            (y < 0.0 ? right : left) = field.vx[j]; // the rod heads up: its right is at -y of its frame
            CHECK(std::abs(field.vy[j]) < 1e-9);    // drift along x is gone
        }
    }
    CHECK(right == Approx(1.0).margin(0.1)); // the mean of all is not quite 0: some have left the window
    CHECK(left == Approx(-1.0).margin(0.1));
    CHECK(outside == 0.0);
    CHECK(field.drag_share.count == 1);
    CHECK(field.drag_share.value == Approx(0.0).margin(0.3)); // as many go up as down
}
