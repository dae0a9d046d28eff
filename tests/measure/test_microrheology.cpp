// Microrheology against beads whose motion is known: Ornstein-Uhlenbeck (bound) and free diffusion.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "synthetic.hpp"

#include <cmath>
#include <functional>
#include <limits>

using namespace rodwake;
using namespace rodwake::measure;
using namespace rodwake::measure::synthetic;

namespace {

using Row = std::vector<double>;
const double a = 4e-4;

/// Beads at random places, each with its own motion about it.
struct Bed {
    Layout layout;
    Normal normal;
    Row x0, y0, x, y; ///< places at the start; displacements
    double drift = 0.0;

    Bed(std::size_t beads, std::uint64_t seed)
        : layout(synthetic::layout(beads)), normal(seed), x(beads, 0.0), y(beads, 0.0) {
        for (std::size_t i = 0; i < beads; ++i) {
            x0.push_back(normal.random.uniform(0.0, layout.box.x));
            y0.push_back(normal.random.uniform(0.0, layout.box.y));
        }
    }
    /// Bound: exact steps of an Ornstein-Uhlenbeck motion of variance `spread`^2, which decays by `keep` a
    /// step.
    void settle(double spread) {
        for (Row* row : {&x, &y})
            for (double& d : *row)
                d = spread * normal();
    }
    void step_bound(double spread, double keep) {
        for (Row* row : {&x, &y})
            for (double& d : *row)
                d = keep * d + std::sqrt(1.0 - keep * keep) * spread * normal();
    }
    void step_free(double length) {
        for (Row* row : {&x, &y})
            for (double& d : *row)
                d += length * normal();
    }
    Frame frame(double time) {
        Row fx = x0, fy = y0;
        for (std::size_t i = 0; i < fx.size(); ++i) {
            fx[i] += x[i] + drift * time;
            fy[i] += y[i] - 2.0 * drift * time;
        }
        return frame_of(layout, time, std::move(fx), std::move(fy));
    }
};

MicrorheologyAccumulator bound_run(std::uint64_t seed, std::size_t frames, double tau, double spread,
                                   double drift = 0.0) {
    Bed bed(400, seed);
    bed.drift = drift;
    bed.settle(spread);
    MicrorheologyAccumulator accumulator(bed.layout, {});
    for (std::size_t k = 0; k < frames; ++k) {
        Frame frame = bed.frame(0.1 * static_cast<double>(k));
        for (Row* v : {&frame.vx, &frame.vy})
            for (double& one : *v)
                one = 3e-3 * bed.normal() + 0.5; // a common velocity is no temperature
        accumulator.add(frame);
        bed.step_bound(spread, std::exp(-0.1 / tau));
    }
    return accumulator;
}

MicrorheologyAccumulator free_run(std::uint64_t seed, std::size_t beads, std::size_t frames, double length) {
    Bed bed(beads, seed);
    MicrorheologyAccumulator accumulator(bed.layout, {});
    for (std::size_t k = 0; k < frames; ++k) {
        accumulator.add(bed.frame(0.1 * static_cast<double>(k)));
        bed.step_free(length);
    }
    return accumulator;
}

/// Mean square of displacements over `lag` frames from every `stride`-th frame on, first `stride` - 1.
double brute_force(const std::vector<Frame>& frames, std::size_t lag, std::size_t stride) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = stride - 1; k + lag < frames.size(); k += stride) {
        const Frame &before = frames[k], &after = frames[k + lag];
        const std::size_t n = before.x.size();
        double mean_x = 0.0, mean_y = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            mean_x += (after.unwrapped_x[i] - before.unwrapped_x[i]) / static_cast<double>(n);
            mean_y += (after.unwrapped_y[i] - before.unwrapped_y[i]) / static_cast<double>(n);
        }
        for (std::size_t i = 0; i < n; ++i) {
            sum += std::pow(after.unwrapped_x[i] - before.unwrapped_x[i] - mean_x, 2) +
                   std::pow(after.unwrapped_y[i] - before.unwrapped_y[i] - mean_y, 2);
            count += 1.0;
        }
    }
    return sum / count;
}

std::vector<Frame> drifting_frames(std::size_t count) {
    Bed bed(50, 5);
    bed.drift = 2.0 * a;
    std::vector<Frame> frames;
    for (std::size_t k = 0; k < count; ++k) {
        frames.push_back(bed.frame(0.1 * static_cast<double>(k)));
        for (double& v : frames.back().vy)
            v = 1e-3 * bed.normal();
        bed.step_free(0.3 * a);
    }
    return frames;
}

MicrorheologyAccumulator accumulator_of(const std::vector<Frame>& frames,
                                        const MicrorheologyOptions& options = {}) {
    MicrorheologyAccumulator accumulator(layout(frames[0].x.size()), options);
    for (const Frame& frame : frames)
        accumulator.add(frame);
    return accumulator;
}

} // namespace

TEST_CASE("each of two kinds of beads has its own stiffness", "[microrheology]") {
    const double spread[] = {0.1 * a, 0.2 * a}; // <Delta> = 4 spread^2 of a bound bead in the plane
    Bed bed(400, 3);
    bed.drift = 2.0 * a;
    bed.layout.kind_radii = {a, 1.4 * a};
    std::vector<std::uint8_t> kind;
    for (std::size_t i = 0; i < 400; ++i)
        kind.push_back(i % 3 == 0 ? 1 : 0);
    const auto scaled_frame = [&](double time) {
        Row x = bed.x, y = bed.y;
        for (std::size_t i = 0; i < 400; ++i) {
            bed.x[i] *= spread[kind[i]];
            bed.y[i] *= spread[kind[i]];
        }
        Frame frame = bed.frame(time);
        bed.x = x;
        bed.y = y;
        frame.kind = kind;
        return frame;
    };
    std::vector<MicrorheologyAccumulator> of_kind;
    for (const std::size_t k : {0U, 1U}) {
        MicrorheologyOptions options;
        options.kind = k;
        of_kind.emplace_back(bed.layout, options);
    }
    bed.settle(1.0);
    for (std::size_t k = 0; k < 400; ++k) {
        for (MicrorheologyAccumulator& one : of_kind) {
            one.add(scaled_frame(0.1 * static_cast<double>(k)));
            if (k == 100)
                one = through_packing(one, MicrorheologyAccumulator(one.layout(), one.options()));
        }
        bed.step_bound(1.0, std::exp(-0.1 / 0.2));
    }
    for (const std::size_t k : {0U, 1U}) {
        const Estimate stiffness = reduced(of_kind[k]).stiffness_zero;
        INFO("kind " << k << ": " << stiffness.value * a * a << " +- " << stiffness.error * a * a);
        CHECK(stiffness.value == Approx(1.0 / (4.0 * spread[k] * spread[k])).epsilon(0.03));
        CHECK(std::abs(stiffness.value * 4.0 * spread[k] * spread[k] - 1.0) <
              4.0 * stiffness.error * 4.0 * spread[k] * spread[k]);
    }
}

TEST_CASE("multi-tau mean-square displacements are the direct ones", "[microrheology]") {
    const std::vector<Frame> frames = drifting_frames(150);
    const MicrorheologyResult result = reduced(accumulator_of(frames));
    std::size_t stride = 1;
    REQUIRE(result.lag.size() == 40);
    for (std::size_t i = 0; i < result.lag.size(); ++i) {
        const auto lag = static_cast<std::size_t>(std::lround(result.lag[i] / 0.1));
        while (lag > 16 * stride)
            stride *= 2;
        CAPTURE(lag, stride);
        // unwrapped places of 1e-2 m, displacements of 1e-4 m: round-off 1e-14
        CHECK(result.msd[i] == Approx(brute_force(frames, lag, stride)).epsilon(1e-12));
        CHECK(result.origins[i] == static_cast<double>(150 / stride - lag / stride));
    }
    CHECK(result.lag.back() >= 12.8);
    CHECK(result.frames == 150);
    CHECK(std::abs(brute_force(frames, 3, 2) / result.msd[2] - 1.0) > 1e-6); // other origins would show
    CHECK(5.0 * std::pow(0.3 * 2.0 * a, 2) > 0.1 * result.msd[2]); // as would the drift, (1 + 2^2) (v t)^2
}

TEST_CASE("drift of the whole bed leaves no trace", "[microrheology]") {
    const MicrorheologyResult one = reduced(bound_run(3, 60, 0.5, 0.2 * a)),
                              other = reduced(bound_run(3, 60, 0.5, 0.2 * a, 3.0 * a));
    for (std::size_t i = 0; i < one.lag.size(); ++i) // places of 1e-2 m against displacements of 1e-4 m
        CHECK(other.msd[i] == Approx(one.msd[i]).epsilon(1e-11));
}

TEST_CASE("bound beads give the stiffness they were given", "[microrheology]") {
    // Delta = 4 spread^2 (1 - exp(-t/tau)): 1/(s Delta~) = (1 + s tau)/(4 spread^2)
    const double spread = 0.25 * a, tau = 0.8, truth = 1.0 / (4.0 * spread * spread);
    for (const std::size_t count : {2, 6}) { // errors over groups of beads, over runs
        std::vector<MicrorheologyAccumulator> runs;
        for (std::uint64_t seed = 0; seed < count; ++seed)
            runs.push_back(bound_run(20 + 10 * count + seed, 1000, tau, spread));
        const MicrorheologyResult result = reduce(runs);
        CAPTURE(count, result.scatter / truth, result.bend / truth);
        CHECK(result.stiffness_zero.value == Approx(truth).epsilon(0.02));
        CHECK(std::abs(result.stiffness_zero.value - truth) < 3.0 * result.stiffness_zero.error);
        CHECK(result.stiffness_zero.error < 0.02 * truth);
        CHECK(result.stiffness_zero.count == (count == 2 ? 32 : 6));
        CHECK_FALSE(result.window_narrowed);
        for (std::size_t i = 0; i < result.s.size(); ++i) {
            // chords lie below the curve: by 1 % at s tau = 1, more where the first lag, 0.12 tau, is felt
            const double off = 4.0 * result.stiffness_error[i] + truth * (0.01 + 0.05 * result.s[i] * tau);
            CHECK(std::abs(result.stiffness[i] - truth * (1.0 + result.s[i] * tau)) < off);
        }
        // T_xy: 9e-6 m^2/s^2 of 4e5 and more values
        CHECK(result.temperature == Approx(9e-6).epsilon(0.01));
        const double factor = 4.0 * 7.2e-7 * result.temperature;
        CHECK(result.spring.value == Approx(factor * result.stiffness_zero.value).epsilon(1e-14));
        CHECK(result.spring.error == Approx(factor * result.stiffness_zero.error).epsilon(1e-14));
    }
}

TEST_CASE("free beads give no stiffness, and the error says how well that is known", "[microrheology]") {
    for (const std::size_t count : {1, 4}) {
        double pulls = 0.0, squares = 0.0;
        const int sets = 16;
        for (int set = 0; set < sets; ++set) {
            std::vector<MicrorheologyAccumulator> runs;
            for (std::size_t run = 0; run < count; ++run)
                runs.push_back(free_run(1000 * count + 10 * set + run, 64, 200, 0.2 * a));
            const MicrorheologyResult result = reduce(runs);
            const double pull = result.stiffness_zero.value / result.scatter;
            pulls += pull;
            squares += pull * pull;
        }
        CAPTURE(count, pulls / sets, squares / sets);
        CHECK(std::abs(pulls / sets) < 4.0 / std::sqrt(sets)); // mean of 16 of unit scatter
        // 16 squares scatter by 0.35; an error of 4 runs (Student, 3 degrees) makes 3 of their mean, and wide
        // tails
        CHECK(squares / sets < (count == 1 ? 3.0 : 9.0));
        CHECK(squares / sets > 0.2);
    }
}

TEST_CASE("the bend of a curve that saturates is seen, a straight one has none", "[microrheology]") {
    // Hopping beads: bound ones whose places of rest diffuse, Delta = A (1 - e^(-t/tau)) + 4 D t, so that
    // 1/(s Delta~) = s/(4 D + A s) falls to 0 below s = 4 D/A, here within the window.
    Bed bed(300, 77);
    MicrorheologyAccumulator accumulator(bed.layout, {});
    Bed rest(300, 78);
    bed.settle(0.2 * a);
    for (std::size_t k = 0; k < 400; ++k) {
        for (std::size_t i = 0; i < 300; ++i) {
            rest.x0[i] = bed.x0[i] + bed.x[i];
            rest.y0[i] = bed.y0[i] + bed.y[i];
        }
        accumulator.add(rest.frame(0.1 * static_cast<double>(k)));
        bed.step_bound(0.2 * a, 0.3);
        rest.step_free(0.04 * a);
    }
    const MicrorheologyResult result = reduced(accumulator);
    CAPTURE(result.stiffness_zero.value * a * a, result.scatter * a * a, result.bend * a * a);
    CHECK(result.bend > 3.0 * result.scatter);
    CHECK(result.stiffness_zero.value > 0.0);
    CHECK(result.stiffness_zero.value < 2.0 * result.stiffness_zero.error); // 0 is not ruled out
}

TEST_CASE("a accumulator stored midway goes on to the bit", "[microrheology]") {
    const std::vector<Frame> frames = drifting_frames(90);
    MicrorheologyAccumulator straight(layout(50), {}), broken(layout(50), {});
    for (std::size_t k = 0; k < frames.size(); ++k) {
        straight.add(frames[k]);
        if (k < 2 || k == 37 || k == 64)
            broken = through_packing(broken, MicrorheologyAccumulator(layout(50), {}));
        broken.add(frames[k]);
    }
    CHECK(saved(broken) == saved(straight));
    CHECK(broken.temperature() > 0.0);
    CHECK(reduced(broken).stiffness == reduced(straight).stiffness);
}

TEST_CASE("what was not saved by such a accumulator is refused", "[microrheology]") {
    const MicrorheologyAccumulator accumulator = accumulator_of(drifting_frames(40));
    const Row row = saved(accumulator);
    MicrorheologyAccumulator other(layout(51), {});
    StateReader in(row, "test");
    CHECK_THROWS_AS(other.load(in), RunError);
    Row twice = row; // frames, last time, interval, temperature, number of beads, first bead
    twice[5] = twice[6];
    MicrorheologyAccumulator same(layout(50), {});
    StateReader again(twice, "test");
    CHECK_THROWS_AS(same.load(again), RunError);
    StateReader cut(std::span<const double>(row).first(row.size() - 1), "test");
    CHECK_THROWS_AS(same.load(cut), RunError);
}

TEST_CASE("uneven frames are named", "[microrheology]") {
    std::vector<Frame> frames = drifting_frames(40);
    frames[20].time += 1e-3;
    CHECK_THROWS_WITH(accumulator_of(frames), Catch::Contains("1.9 s") && Catch::Contains("2.001 s"));
    CHECK_THROWS_AS(accumulator_of(frames), RunError);
    frames = drifting_frames(5);
    frames[3].time = frames[2].time;
    CHECK_THROWS_AS(accumulator_of(frames), RunError);
    frames = drifting_frames(5);
    frames[2].x[0] = frames[2].x[1] = layout(50).box.x;
    CHECK_THROWS_AS(accumulator_of(frames), RunError);
    frames = drifting_frames(5);
    frames[2].vx.pop_back();
    CHECK_THROWS_AS(accumulator_of(frames), RunError);
}

TEST_CASE("the longest lag is kept to", "[microrheology]") {
    const std::vector<Frame> frames = drifting_frames(100);
    for (const double longest : {1.6, 2.0, 3.3}) {
        const MicrorheologyResult result = reduced(accumulator_of(frames, {longest, {}, {}}));
        CHECK(result.lag.back() <= longest + 1e-9);
        CHECK(result.lag.back() > longest - 0.2);
    }
    CHECK_THROWS_AS(accumulator_of(frames, {0.05, {}, {}}), InputError);
    CHECK_THROWS_AS(reduced(accumulator_of(frames, {0.4, {}, {}})),
                    InputError); // a window below half a frame's rate has no room
}

TEST_CASE("the window for s -> 0 is the wanted one as far as the lags allow", "[microrheology]") {
    const std::vector<Frame> frames = drifting_frames(200);
    const auto window = [&](std::optional<double> low, std::optional<double> high) {
        return reduced(accumulator_of(frames, {0.0, low, high}));
    };
    const MicrorheologyResult wanted = window(0.5, 1.5);
    CHECK(wanted.s_low == 0.5);
    CHECK(wanted.s_high == 1.5);
    CHECK_FALSE(wanted.window_narrowed);
    const MicrorheologyResult narrowed = window(1e-3, 100.0);
    CHECK(narrowed.window_narrowed);
    CHECK(narrowed.s_low > 1.0 / 15.0); // longest lag at most 3/4 of 20 s
    CHECK(narrowed.s_high == Approx(5.0).epsilon(1e-9));
    const double none = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(window(2.0, {}), InputError); // beyond the default upper end
    CHECK_THROWS_AS(window({}, none), InputError);
    for (const auto& [low, high] : {std::pair{1e-4, 1e-3}, {100.0, 200.0}, {2.0, 1.0}, {-1.0, 1.0}})
        CHECK_THROWS_AS(window(low, high), InputError);
}

TEST_CASE("microrheology refuses runs it cannot use", "[microrheology]") {
    CHECK_THROWS_AS(reduce(std::span<const MicrorheologyAccumulator>()), InputError);
    CHECK_THROWS_AS(MicrorheologyAccumulator(layout(15), {}), InputError);
    CHECK_THROWS_AS(MicrorheologyAccumulator(layout(50), {-1.0, {}, {}}), InputError);
    const std::vector<Frame> frames = drifting_frames(40);
    const MicrorheologyAccumulator empty(layout(50), {}),
        shorter = accumulator_of({frames.begin(), frames.begin() + 31});
    CHECK(empty.temperature() == 0.0);
    CHECK_THROWS_AS(reduced(empty), InputError);
    CHECK_THROWS_AS(reduced(shorter), InputError);
    const std::vector<MicrorheologyAccumulator> options = {accumulator_of(frames),
                                                           accumulator_of(frames, {3.0, {}, {}})};
    CHECK_THROWS_AS(reduce(options), InputError);
    std::vector<Frame> slow = frames, frozen = frames;
    for (Frame& frame : slow)
        frame.time *= 2.0;
    const std::vector<MicrorheologyAccumulator> intervals = {accumulator_of(frames), accumulator_of(slow)};
    CHECK_THROWS_AS(reduce(intervals), InputError);
    for (std::size_t k = 1; k < frozen.size(); ++k) {
        frozen[k] = frozen[0];
        frozen[k].time = frames[k].time;
    }
    CHECK_THROWS_AS(reduced(accumulator_of(frozen)), InputError);
}

TEST_CASE("the smallest run there is gives finite numbers", "[microrheology]") {
    const MicrorheologyResult result = reduced(accumulator_of(drifting_frames(32)));
    for (const Row* row : {&result.msd, &result.msd_error, &result.stiffness, &result.stiffness_error})
        for (const double value : *row)
            CHECK(std::isfinite(value));
    CHECK(std::isfinite(result.stiffness_zero.value));
    CHECK(result.stiffness_zero.error > 0.0);
}

TEST_CASE("another temperature scales the spring and its error, and leaves the stiffness",
          "[microrheology]") {
    MicrorheologyResult result;
    result.temperature = 2e-4;
    result.stiffness_zero = {3.0, 0.5, 8};
    result.spring = {6.0, 1.0, 8};
    result.use_temperature(1e-4);
    CHECK(result.temperature == 1e-4);
    CHECK(result.spring.value == Approx(3.0).epsilon(1e-15)); // round-off
    CHECK(result.spring.error == Approx(0.5).epsilon(1e-15));
    CHECK(result.stiffness_zero.value == 3.0);
    result.spring.error = rodwake::unknown_error;
    result.use_temperature(3e-4);
    CHECK_FALSE(result.spring.known());
}

namespace {

/// Of a camera over bound or free beads: 300 of them, 400 pictures.
MicrorheologyResult filmed(double keep, double noise, const Localisation& localisation) {
    Bed bed(300, 11);
    bed.layout.velocities = false;
    MicrorheologyAccumulator sums(bed.layout, {0.0, {}, {}, localisation});
    Normal error(5);
    bed.settle(0.1 * a);
    for (int f = 0; f < 400; ++f) {
        Frame frame = bed.frame(0.02 * f);
        frame.vx.clear();
        frame.vy.clear();
        for (auto* row : {&frame.unwrapped_x, &frame.unwrapped_y})
            for (double& place : *row)
                place += noise * error();
        sums.add(frame);
        keep > 0.0 ? bed.step_bound(0.1 * a, keep) : bed.step_free(0.03 * a);
    }
    return reduced(sums);
}

} // namespace

TEST_CASE("a camera's error is found in the first lags and taken off", "[microrheology]") {
    for (const double keep : {0.0, 0.6, 0.9}) {
        CAPTURE(keep);
        const MicrorheologyResult clear = filmed(keep, 0.0, {}), found = filmed(keep, 0.05 * a, {true, 0.0}),
                                  given = filmed(keep, 0.05 * a, {false, 0.05 * a}),
                                  blurred = filmed(keep, 0.05 * a, {});
        REQUIRE(found.localisation);
        CHECK(std::abs(found.localisation->value - 0.05 * a) < 3.0 * found.localisation->error);
        CHECK(found.localisation->error < 0.006 * a);
        CHECK(blurred.localisation->value == found.localisation->value);
        CHECK(blurred.taken_off == 0.0);
        CHECK(given.taken_off == Approx(4.0 * 0.0025 * a * a));
        for (std::size_t i = 0; i < 8; ++i) {
            CHECK(std::abs(found.msd[i] - clear.msd[i]) < 4.0 * found.msd_error[i]);
            CHECK(std::abs(given.msd[i] - clear.msd[i]) < 4.0 * (given.msd_error[i] + 1e-4 * a * a));
            CHECK(blurred.msd[i] - clear.msd[i] > 0.008 * a * a);
        }
        CHECK(found.msd_error[0] > given.msd_error[0]); // it knows less
        const double off = found.stiffness_zero.value - clear.stiffness_zero.value;
        CHECK(std::abs(off) < 3.0 * std::hypot(found.stiffness_zero.error, clear.stiffness_zero.error));
    }
    CHECK_FALSE(filmed(0.1, 0.05 * a, {true, 0.0}).localisation); // round the cage between two pictures
    CHECK_THROWS_WITH(filmed(0.6, 0.0, {false, 0.1 * a}), Catch::Contains("nothing of the beads is left"));
}
