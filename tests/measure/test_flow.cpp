// Flow around a rod from beads whose velocity in the rod's frame is known.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/flow.hpp"
#include "synthetic.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

using namespace rodwake;
using namespace rodwake::measure;
using namespace rodwake::measure::synthetic;

namespace {

using Row = std::vector<double>;
const double a = 4e-4, speed = 2.5 * a, step = 0.1;

/// Velocity in the rod's frame of a bead seen at (x, y) there.
using Field = std::function<RelativePosition(double, double)>;

struct Motion {
    double turn_rate = 0.0, drift = 0.0;
    RodPosition rod = {70 * a, 75 * a, 0.4}; ///< so that it crosses both edges of the box
};

/// Beads that step as the field says where they are halfway. Those farther than 30 a move against it, evenly,
/// so that no mean remains but the drift.
struct FlowBed {
    Layout layout = synthetic::layout(1500, 1);
    Motion motion;
    Field field;
    Row x, y;
    double time = 0.0;

    FlowBed(Motion m, Field f, std::uint64_t seed = 1) : motion(m), field(std::move(f)) {
        RandomStream random(seed);
        for (std::size_t i = 0; i < layout.beads; ++i) {
            x.push_back(random.uniform(0.0, layout.box.x));
            y.push_back(random.uniform(0.0, layout.box.y));
        }
    }
    Frame frame() const {
        RodPosition rod = motion.rod;
        rod.heading = std::remainder(rod.heading, 2.0 * std::numbers::pi);
        return frame_of(layout, time, x, y, {rod});
    }
    void advance() {
        RodPosition half = motion.rod, after = motion.rod;
        half.heading += motion.turn_rate * step / 2.0;
        after.heading += motion.turn_rate * step;
        after.x += speed * step * std::cos(half.heading) + motion.drift * step;
        after.y += speed * step * std::sin(half.heading);
        half.x = (motion.rod.x + after.x) / 2.0;
        half.y = (motion.rod.y + after.y) / 2.0;
        const double c = std::cos(half.heading), s = std::sin(half.heading);
        Row sx(x.size(), 0.0), sy = sx;
        std::vector<std::size_t> far;
        double sum_x = 0.0, sum_y = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            if (const RelativePosition now = relative_position(half, x[i], y[i], layout.box);
                std::hypot(now.x, now.y) > 30 * a) {
                far.push_back(i);
                continue;
            }
            RelativePosition v = {};
            for (int iteration = 0; iteration < 12; ++iteration) { // halfway depends on the step
                const RelativePosition at = relative_position(
                    half, x[i] + sx[i] / 2.0 + motion.drift * step / 2.0, y[i] + sy[i] / 2.0, layout.box);
                v = field(at.x, at.y);
                sx[i] = step * (c * v.x - s * v.y);
                sy[i] = step * (s * v.x + c * v.y);
            }
            sum_x += sx[i];
            sum_y += sy[i];
        }
        for (const std::size_t i : far) {
            sx[i] = -sum_x / static_cast<double>(far.size());
            sy[i] = -sum_y / static_cast<double>(far.size());
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i] += sx[i] + motion.drift * step;
            y[i] += sy[i];
        }
        motion.rod = after;
        time += step;
    }
};

const FlowOptions options = {0, 2.0 * a, 0.1, 5.0, 0.0, 0.0};

FlowAccumulator run_of(FlowBed bed, const FlowOptions& k, int frames) {
    FlowAccumulator accumulator(bed.layout, k);
    for (int n = 0; n < frames; ++n) {
        accumulator.add(bed.frame());
        bed.advance();
    }
    return accumulator;
}

RelativePosition uniform(double, double) { return {0.3 * speed, -0.1 * speed}; }
RelativePosition rest(double, double) { return {}; }
RelativePosition smooth(double x, double y) {
    const double g = std::exp(-(x * x + y * y) / (2.0 * 64.0 * a * a));
    return {0.5 * speed * g, -0.2 * speed * g * y / (8.0 * a)};
}

/// Largest difference to the field at the middles of bins within `within`, over `scale`.
double worst(const FlowField& flow, const Field& field, double within, double scale) {
    double most = 0.0;
    for (std::size_t j = 0; j < flow.grid.rows; ++j)
        for (std::size_t i = 0; i < flow.grid.columns; ++i) {
            const double x = flow.grid.x(i), y = flow.grid.y(j);
            const std::size_t bin = j * flow.grid.columns + i;
            if (std::hypot(x, y) > within || flow.count[bin] == 0.0)
                continue;
            const RelativePosition v = field(x, y);
            most = std::max(most, std::hypot(flow.vx[bin] - v.x, flow.vy[bin] - v.y) / scale);
        }
    return most;
}

std::size_t near_bin(const FlowField& flow) { return *flow.grid.bin(0.0, 4.0 * a); }

} // namespace

TEST_CASE("uniform flow around a rod is found exactly: turning, drifting, across the edges", "[flow]") {
    for (const Motion& motion : {Motion{}, Motion{0.5, 0.0}, Motion{0.5, 3.0 * a},
                                 Motion{0.0, 0.0, {0, 0, 3.1}}, Motion{0.3, -a, {-200 * a, 300 * a, 3.1}}}) {
        const FlowField flow = reduced(run_of(FlowBed(motion, uniform), options, 60));
        // The field ends at 30 a. Round-off of places (1e-1 m at most) over a step of 1e-4 m: 1e-13.
        CHECK(worst(flow, uniform, 27 * a, speed) < 1e-10);
        CHECK(worst(flow, rest, 27 * a, speed) > 0.3); // the comparison can fail
        const std::size_t bin = near_bin(flow);
        CHECK(std::hypot(flow.unit_x[bin], flow.unit_y[bin]) == Approx(1.0).epsilon(1e-10));
        CHECK(flow.near_speed == Approx(std::hypot(0.3, 0.1) * speed).epsilon(1e-10));
        CHECK(flow.frames == 60);
        CHECK(flow.blocks == 2); // middles of pairs at 0.05 s to 5.85 s
    }
}

TEST_CASE("beads at rest have velocity 0, not the rod's", "[flow]") {
    const FlowField flow = reduced(run_of(FlowBed({0.2, 2.0 * a}, rest), options, 20));
    CHECK(worst(flow, rest, 80 * a, speed) < 1e-10);
    CHECK(flow.near_speed < 1e-10 * speed);
}

TEST_CASE("a bead counts in the bin where it was halfway, in the rod's frame halfway", "[flow]") {
    const Layout layout = synthetic::layout(2, 1);
    FlowAccumulator accumulator(layout,
                                options); // rod at the origin, then at (4 a, 0), turned by a right angle
    accumulator.add(frame_of(layout, 0.0, {8 * a, 40 * a}, {-2 * a, 40 * a}, {{0, 0, 0.0}}));
    accumulator.add(
        frame_of(layout, 0.1, {12 * a, 40 * a}, {6 * a, 40 * a}, {{4 * a, 0, std::numbers::pi / 2.0}}));
    const FlowField flow = reduced(accumulator);
    // Halfway at (8 a, 2 a) from the rod, which heads at 45 degrees: (10, -6)/sqrt(2). It moves by 8 a less
    // the mean, 4 a, along y.
    const auto bin = flow.grid.bin(10 * a / std::sqrt(2.0), -6 * a / std::sqrt(2.0));
    REQUIRE(bin);
    CHECK(flow.count[*bin] == 1.0);
    CHECK(flow.vx[*bin] == Approx(60 * a / std::sqrt(2.0)).epsilon(1e-12));
    CHECK(flow.vy[*bin] == Approx(20 * a / std::sqrt(2.0)).epsilon(1e-12));
    CHECK(flow.unit_x[*bin] == Approx(3.0 / std::sqrt(10.0)).epsilon(1e-12));
}

TEST_CASE("a smooth flow is found to the width of a bin", "[flow]") {
    // Beads of a bin are off its middle by up to 1.4 a, where the field changes by up to 0.6/(8 a) of 0.5 v:
    // 5 %
    CHECK(worst(reduced(run_of(FlowBed({0.3, a}, smooth), options, 200)), smooth, 25 * a, speed) < 0.06);
    // With a lag of 5 frames the rod goes 1.25 a and turns by 0.15; halfway counts, so it changes little
    FlowOptions longer = options;
    longer.lag = 0.5;
    CHECK(worst(reduced(run_of(FlowBed({0.3, a}, smooth), longer, 200)), smooth, 25 * a, speed) < 0.08);
}

TEST_CASE("errors are those of the scatter over blocks and runs", "[flow]") {
    // Each run its own steady speed: standard errors of the mean of 8 blocks.
    std::vector<FlowAccumulator> runs;
    const double part[4] = {1.0, 2.0, 3.0, 6.0};
    for (const double p : part) {
        FlowOptions k = options;
        k.block = 1e3;
        runs.push_back(run_of(FlowBed({},
                                      [p](double, double) {
                                          return RelativePosition{p * 0.1 * speed, 0.0};
                                      }),
                              k, 40));
    }
    const FlowField flow = reduce(runs);
    CHECK(flow.blocks == 4);
    const std::size_t bin = near_bin(flow);
    Row values, weights;
    for (const FlowAccumulator& run : runs) {
        values.push_back(run.blocks()[0].vx[bin] / run.blocks()[0].count[bin]);
        weights.push_back(run.blocks()[0].count[bin]);
    }
    const Estimate mean = mean_of_blocks(values, weights);
    CHECK(flow.vx[bin] == mean.value);
    CHECK(flow.sigma_x[bin] == mean.error);
    CHECK(mean.error > 0.05 * speed);
    CHECK(flow.sigma_y[bin] < 1e-10 * speed);
    const FlowField single = reduced(runs[0]);
    CHECK(std::isnan(single.sigma_x[bin])); // one block: unknown
    CHECK(single.vx[bin] == Approx(0.1 * speed).epsilon(1e-10));
}

TEST_CASE("bins without beads are 0 with count 0", "[flow]") {
    FlowBed bed({}, rest);
    for (std::size_t i = 0; i < bed.x.size(); ++i) // all in a corner
        bed.x[i] *= 0.3, bed.y[i] *= 0.3;
    const FlowField flow = reduced(run_of(bed, options, 5));
    std::size_t empty = 0;
    for (std::size_t bin = 0; bin < flow.grid.bins(); ++bin) {
        for (const Row* row : {&flow.vx, &flow.vy, &flow.unit_x, &flow.unit_y})
            CHECK(std::isfinite((*row)[bin]));
        for (const Row* row : {&flow.sigma_x, &flow.sigma_y}) // unknown where beads came
            CHECK(std::isnan((*row)[bin]) == (flow.count[bin] > 0.0));
        if (flow.count[bin] > 0.0)
            continue;
        ++empty;
        CHECK((flow.vx[bin] == 0.0 && flow.sigma_x[bin] == 0.0));
    }
    CHECK(empty > flow.grid.bins() / 2);
}

TEST_CASE("marked beads are dragged along or left behind", "[flow]") {
    FlowOptions marking = options;
    marking.marked_within = 6.0 * a;
    const Field dragged = [](double x, double y) {
        return std::hypot(x, y) < 15 * a ? RelativePosition{speed, 0.0} : RelativePosition{};
    };
    for (const double drift : {0.0, 2.0 * a}) {
        const std::vector<FlowAccumulator> along = {
            run_of(FlowBed({0.0, drift}, dragged, 1), marking, 40),
            run_of(FlowBed({0.0, drift, {a, a, -3.0}}, dragged, 2), marking, 40)};
        const FlowField flow = reduce(along);
        CHECK(flow.drag_share.value == Approx(1.0).epsilon(1e-10));
        CHECK(flow.drag.value == Approx(speed * 3.9).epsilon(1e-10));
        CHECK(flow.drag.count == 2);
        CHECK(flow.marked.size() > 10); // 1500 beads of 78^2: 28 within 6 a
        CHECK(along[0].rod_travel() == Approx(speed * 3.9).epsilon(1e-10));
        CHECK(reduced(run_of(FlowBed({0.0, drift}, rest), marking, 40)).drag_share.value ==
              Approx(0.0).margin(1e-10));
    }
    const FlowField none = reduced(run_of(FlowBed({}, dragged), options, 40));
    CHECK(none.drag.count == 0);
    CHECK(none.marked.empty());
}

TEST_CASE("marked beads are those near the rod at first, and are followed as far as wanted", "[flow]") {
    FlowOptions marking = options;
    marking.marked_within = 6.0 * a;
    marking.marked_travel = 4.9 * a; // 20 steps of 0.25 a
    const FlowBed bed({}, uniform);
    const FlowAccumulator accumulator = run_of(bed, marking, 60);
    std::size_t within = 0;
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
        const RelativePosition seen = relative_position(bed.motion.rod, bed.x[i], bed.y[i], bed.layout.box);
        within += std::hypot(seen.x, seen.y) < 6.0 * a;
    }
    const std::vector<MarkedBead> beads = accumulator.marked();
    CHECK(beads.size() == within);
    CHECK(accumulator.rod_travel() == Approx(5.0 * a).epsilon(1e-10));
    for (const MarkedBead& bead : beads) {
        CHECK(bead.x0 == bed.x[bead.bead]);
        CHECK(std::hypot(bead.x1 - bead.x0, bead.y1 - bead.y0) ==
              Approx(std::hypot(0.3, 0.1) * 5.0 * a).epsilon(1e-9));
    }
}

TEST_CASE("a flow accumulator stored in the middle of a lag goes on to the bit", "[flow]") {
    FlowOptions k = options;
    k.lag = 0.7;
    k.block = 1.0;
    k.marked_within = 6.0 * a;
    FlowBed bed({0.4, a}, smooth);
    FlowAccumulator straight(bed.layout, k), broken(bed.layout, k);
    for (int n = 0; n < 40; ++n) {
        const Frame frame = bed.frame();
        straight.add(frame);
        if (n < 3 || n == 5 || n == 22)
            broken = through_packing(broken, FlowAccumulator(bed.layout, k));
        broken.add(frame);
        bed.advance();
    }
    CHECK(saved(broken) == saved(straight));
    CHECK(reduced(broken).blocks == 4);
    const Row row = saved(straight);
    FlowOptions coarse = k;
    coarse.spacing = 4.0 * a;
    FlowAccumulator other(bed.layout, coarse);
    StateReader in(row, "test");
    CHECK_THROWS_AS(other.load(in), RunError);
}

TEST_CASE("flow refuses options and runs it cannot use", "[flow]") {
    const Layout bed = synthetic::layout(1500, 1);
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto with = [](auto FlowOptions::*key, auto value) {
        FlowOptions k = options;
        k.*key = value;
        return k;
    };
    CHECK_NOTHROW(FlowAccumulator(bed, options));
    CHECK_THROWS_AS(FlowAccumulator(bed, with(&FlowOptions::rod, std::size_t{1})), InputError);
    CHECK_THROWS_AS(FlowAccumulator(synthetic::layout(1500), options), InputError);
    for (const double bad : {-1.0, none}) {
        for (double FlowOptions::*key : {&FlowOptions::spacing, &FlowOptions::lag, &FlowOptions::block,
                                         &FlowOptions::marked_within, &FlowOptions::marked_travel})
            CHECK_THROWS_AS(FlowAccumulator(bed, with(key, bad)), InputError);
    }
    CHECK_THROWS_AS(FlowAccumulator(bed, with(&FlowOptions::lag, 6.0)), InputError); // above the block
    CHECK_THROWS_AS(FlowAccumulator(bed, with(&FlowOptions::spacing, 20.0 * a)), InputError);
    CHECK_THROWS_AS(FlowAccumulator(bed, with(&FlowOptions::marked_within, 40.0 * a)), InputError);

    CHECK_THROWS_AS(reduce(std::span<const FlowAccumulator>()), InputError);
    CHECK_THROWS_AS(reduced(run_of(FlowBed({}, rest), options, 1)), InputError);
    CHECK_THROWS_AS(reduced(run_of(FlowBed({}, rest), with(&FlowOptions::lag, 1.0), 10)), InputError);
    const std::vector<FlowAccumulator> mixed = {run_of(FlowBed({}, rest), options, 3),
                                                run_of(FlowBed({}, rest), with(&FlowOptions::lag, 0.2), 5)};
    CHECK_THROWS_AS(reduce(mixed), InputError);

    FlowBed uneven({}, rest);
    FlowAccumulator accumulator(bed, options);
    for (const double time : {0.0, 0.1}) {
        uneven.time = time;
        accumulator.add(uneven.frame());
    }
    for (const double time : {0.25, 0.1, 0.0}) {
        FlowAccumulator copy = accumulator;
        uneven.time = time;
        CHECK_THROWS_AS(copy.add(uneven.frame()), RunError);
    }
    Frame stray = uneven.frame();
    stray.rods.clear();
    CHECK_THROWS_AS(accumulator.add(stray), RunError);
}
