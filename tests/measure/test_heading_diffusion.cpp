// Heading diffusion of made-up tracks: Brownian headings of known strength.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/heading_diffusion.hpp"
#include "synthetic.hpp"

#include <algorithm>
#include <cmath>
#include <random>

using namespace rodwake;
using namespace rodwake::measure;
using namespace rodwake::measure::synthetic;
using Catch::Matchers::Contains;

namespace {

constexpr double D_true = 0.05, speed_true = 2e-3, step = 0.02; // rad^2/s, m/s, s

struct Rattle {
    double jitter = 0.0, turning = 0.0; // rms, rad; rad/s
};

/// A rod that walks along its heading, which diffuses, rattles and turns.
HeadingTrack walked(std::uint64_t seed, double length, const Rattle& rattle = {}) {
    Normal normal(seed);
    HeadingTrack track;
    double heading = 0.3, x = 0.0, y = 0.0;
    const auto rows = static_cast<int>(length / step + 0.5);
    for (int i = 0; i <= rows; ++i) {
        track.time.push_back(step * i);
        track.x.push_back(x);
        track.y.push_back(y);
        track.heading.push_back(heading + rattle.jitter * normal());
        const double change = std::sqrt(2.0 * D_true * step) * normal() + rattle.turning * step;
        x += speed_true * step * std::cos(heading + 0.5 * change);
        y += speed_true * step * std::sin(heading + 0.5 * change);
        heading += change;
    }
    return track;
}

std::vector<HeadingTrack> many(std::size_t runs, double length, std::uint64_t first,
                               const Rattle& rattle = {}) {
    std::vector<HeadingTrack> tracks;
    for (std::size_t i = 0; i < runs; ++i)
        tracks.push_back(walked(first + i, length, rattle));
    return tracks;
}

constexpr HeadingOptions options{5.0, 0.2, 1.0};

} // namespace

TEST_CASE("heading diffusion: Brownian headings within 2 %, by the square and by the cosine") {
    // 64 runs of 200 s: 12 800 s; the standard error is 1.1 % of D, the seeds are fixed.
    const HeadingDiffusion r = heading_diffusion(many(64, 200.0, 1), options);
    CHECK(r.diffusion.value == Approx(D_true).epsilon(0.02));
    CHECK(r.diffusion_cosine.value == Approx(D_true).epsilon(0.02));
    CHECK(r.diffusion.error < 0.015 * D_true);
    CHECK(r.early.value == Approx(D_true).margin(4.0 * r.early.error));
    CHECK(r.late.value == Approx(D_true).margin(4.0 * r.late.error));
    CHECK(r.speed.value == Approx(speed_true).epsilon(1e-3)); // the chord of a step is shorter than its arc
    CHECK(r.diffusion_per_length.value == Approx(r.diffusion.value / r.speed.value));
    CHECK(r.jitter < 0.02);
    CHECK(r.parts == 64);
    CHECK(r.blocks == 64 * 40);
    CHECK(r.lag_low == Approx(0.2));
    CHECK(r.lag_high == Approx(1.0));
}

TEST_CASE("heading diffusion: rattling is distinguished, a steady turn is reported") {
    const HeadingDiffusion r = heading_diffusion(many(32, 200.0, 101, {0.1, 0.0}), options);
    CHECK(r.diffusion.value == Approx(D_true).margin(4.0 * r.diffusion.error));
    CHECK(r.diffusion.error < 0.05 * D_true);
    CHECK(r.diffusion_cosine.value == Approx(D_true).margin(4.0 * r.diffusion_cosine.error));
    CHECK(r.jitter == Approx(0.1).epsilon(0.05)); // 2 j^2 = 0.02 +- 0.0005
    CHECK(r.cosine_amplitude == Approx(std::exp(-0.01)).margin(2e-3));
    CHECK(r.square[0] == Approx(0.02 + 2.0 * D_true * step).epsilon(0.02)); // 10^4 rows a run
    const HeadingDiffusion turning = heading_diffusion(many(32, 200.0, 201, {0.0, 0.5}), options);
    CHECK(turning.turn_rate.value == Approx(0.5).margin(4.0 * turning.turn_rate.error));
    CHECK(turning.turn_rate.error == Approx(std::sqrt(2.0 * D_true / 6400.0)).epsilon(0.4));
    CHECK(turning.late.value >
          1.5 * turning.early.value); // (0.5 tau)^2 beside 0.1 tau: mean slopes 0.26, 0.45
}

TEST_CASE("heading diffusion: the interval holds the truth as often as it says", "[.][long]") {
    // 300 sets each; 95 % less three binomial errors of 1.3 % is 91 %.
    int of_runs = 0, of_blocks = 0;
    constexpr int sets = 300;
    for (int set = 0; set < sets; ++set) {
        const auto first = static_cast<std::uint64_t>(1000 + 20 * set);
        const HeadingDiffusion runs = heading_diffusion(many(12, 10.0, first), options);
        const HeadingDiffusion blocks = heading_diffusion(many(1, 120.0, first + 15), options);
        of_runs += runs.low <= D_true && D_true <= runs.high;
        of_blocks += blocks.low <= D_true && D_true <= blocks.high;
        CHECK(runs.parts == 12);
        CHECK(blocks.parts == 24);
    }
    INFO(of_runs << " and " << of_blocks << " of " << sets);
    CHECK(of_runs >= 273);
    CHECK(of_blocks >= 273);
}

TEST_CASE("heading diffusion: a single block has no error; fast headings have no cosine") {
    const HeadingDiffusion r = heading_diffusion(many(1, 5.0, 7), options);
    CHECK(r.blocks == 1);
    CHECK_FALSE(r.diffusion.known());
    CHECK(heading_diffusion(many(1, 10.0, 7), options).diffusion.known()); // two blocks do
    CHECK(std::isnan(r.high));
    HeadingTrack fast = walked(8, 40.0);
    for (double& heading : fast.heading)
        heading *= 14.0; // D of 9.8 rad^2/s: the cosine is 0.2 at 0.16 s, before the window
    const HeadingDiffusion lost = heading_diffusion(std::vector{fast}, options);
    CHECK(lost.diffusion_cosine.count == 0);
    CHECK(lost.diffusion.value == Approx(196.0 * D_true).margin(4.0 * lost.diffusion.error));
}

TEST_CASE("heading diffusion: tracks and windows that cannot serve are refused") {
    const auto refused = [](const std::vector<HeadingTrack>& runs, const HeadingOptions& o, const char* why) {
        CHECK_THROWS_WITH(heading_diffusion(runs, o), Contains(why));
    };
    refused({}, options, "no runs");
    refused(many(1, 10.0, 1), {5.0, 1.0, 0.2}, "must be positive and rise");
    refused(many(1, 1.5, 1), options, "need twice as much");
    refused(many(1, 10.0, 1), {5.0, 0.9, 0.94}, "fewer than 4 lags");
    refused(many(1, 10.0, 1), {5.0, 0.001, 0.01}, "no lag up to 0.01 s");
    refused(many(1, 10.0, 1), {1.0, 0.2, 3.0}, "need blocks of twice as much, not 1 s");
    std::vector<HeadingTrack> second_is_empty = many(1, 10.0, 1);
    second_is_empty.emplace_back();
    refused(second_is_empty, options, "a run has 0 rows: start sooner");
    std::vector<HeadingTrack> stopped = many(1, 10.0, 1);
    stopped[0].time.back() -= 0.01; // the end of a run may lie between two rows
    CHECK(heading_diffusion(stopped, options).blocks == 1);
}

TEST_CASE("heading diffusion: rows of a film may be missing, or come at uneven times") {
    const HeadingOptions filmed{10.0, 0.1, 1.0};
    const HeadingDiffusion whole = heading_diffusion(many(4, 40.0, 3), filmed);
    for (const double jitter : {0.0, 0.7}) { // of a step: on no grid
        std::vector<HeadingTrack> some(4);
        std::mt19937 random(2);
        for (std::size_t run = 0; run < 4; ++run) {
            const HeadingTrack all = many(4, 40.0, 3)[run];
            const double step = all.time[1] - all.time[0];
            for (std::size_t i = 0; i < all.time.size(); ++i)
                if (i < 2 || random() % 3 > 0) {
                    const double part =
                        i < 2 || i + 1 == all.time.size() ? 0.0 : jitter * static_cast<double>(i % 7) / 7.0;
                    some[run].time.push_back(all.time[i] + part * step);
                    some[run].x.push_back(all.x[i]);
                    some[run].y.push_back(all.y[i]);
                    some[run].heading.push_back(i + 1 == all.time.size() ? all.heading[i]
                                                                         : all.heading[i] * (1.0 - part) +
                                                                               all.heading[i + 1] * part);
                }
        }
        const HeadingDiffusion part = heading_diffusion(some, filmed);
        INFO(jitter);
        CHECK(part.diffusion.value == Approx(whole.diffusion.value).margin(2.0 * whole.diffusion.error));
        CHECK(part.origins.back() > 0.3 * whole.origins.back());
        CHECK(part.speed.value == Approx(whole.speed.value).epsilon(0.05));
        CHECK(std::ranges::is_sorted(part.lag));
    }
}
