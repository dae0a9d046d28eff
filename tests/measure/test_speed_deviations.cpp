// Large deviations of made-up walks whose function F is known in closed form.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/speed_deviations.hpp"
#include "synthetic.hpp"

#include <cmath>
#include <functional>

using namespace rodwake;
using namespace rodwake::measure;
using namespace rodwake::measure::synthetic;
using Catch::Matchers::Contains;

namespace {

constexpr double step = 0.01, v = 2e-3, D = 2e-7; // s, m/s, m^2/s: v^2/D = 20 1/s

/// Walks along its heading, which turns steadily so that a fixed direction would not do, by what `draw` says.
HeadingTrack walked(double length, const std::function<double()>& draw) {
    HeadingTrack track;
    double heading = 0.3, x = 0.0, y = 0.0;
    const auto rows = static_cast<int>(length / step + 0.5);
    for (int i = 0; i <= rows; ++i) {
        track.time.push_back(step * i);
        track.x.push_back(x);
        track.y.push_back(y);
        track.heading.push_back(heading);
        const double way = draw(), turn = 0.01;
        x += way * std::cos(heading + 0.5 * turn);
        y += way * std::sin(heading + 0.5 * turn);
        heading += turn;
    }
    return track;
}

std::vector<HeadingTrack> gaussian(std::size_t runs, double length, std::uint64_t first, double speed = v) {
    std::vector<HeadingTrack> tracks;
    for (std::size_t i = 0; i < runs; ++i) {
        Normal normal(first + i);
        tracks.push_back(walked(length, [&] { return speed * step + std::sqrt(2.0 * D * step) * normal(); }));
    }
    return tracks;
}

/// P of a step in units of v step: exp(b x - c |x|), c > |b|, times a constant.
std::vector<HeadingTrack> kinked(double b, double c, double& mean) {
    const double ahead = 1.0 / (c - b), behind = 1.0 / (c + b); // mean sizes of steps, and their shares
    mean = (ahead * ahead - behind * behind) / (ahead + behind);
    std::vector<HeadingTrack> tracks;
    for (std::size_t i = 0; i < 16; ++i) {
        RandomStream random(900 + i);
        tracks.push_back(walked(200.0, [&] {
            const bool forwards = random.uniform() * (ahead + behind) < ahead;
            return v * step * -std::log(random.uniform()) * (forwards ? ahead : -behind);
        }));
    }
    return tracks;
}

constexpr DeviationOptions options{10.0, 0.32};

} // namespace

TEST_CASE("speed deviations: a Gaussian walk has its F, its straight antisymmetric part and no kink") {
    const SpeedDeviations r = speed_deviations(gaussian(16, 400.0, 1), options);
    CHECK(r.speed.value == Approx(v).epsilon(0.02));
    CHECK(r.parts == 16);
    REQUIRE(r.lags.size() == 6);
    CHECK(r.lags[0].lag == Approx(0.01));
    CHECK(r.lags[5].lag == Approx(0.32));
    REQUIRE(r.told < 6);
    for (std::size_t k = 0; k <= r.told; ++k) {
        const DeviationLag& lag = r.lags[k];
        CAPTURE(lag.lag);
        CHECK(lag.variance == Approx(2.0 * D / (v * v * lag.lag)).epsilon(0.03));
        CHECK(lag.slope.value ==
              Approx(-v * v / D).margin(4.0 * lag.slope.error + 0.01 * v * v / D)); // bins: 0.9 %
        CHECK(lag.slope.error < 0.08 * v * v / D);
        CHECK(lag.gaussian_slope == Approx(-v * v / D).epsilon(0.03));
        CHECK(std::abs(lag.cubic.value) < 4.0 * lag.cubic.error);
        CHECK(std::abs(lag.kink.value) < 4.0 * lag.kink.error);
        CHECK(lag.backwards == Approx(0.5 * std::erfc(std::sqrt(v * v * lag.lag / (4.0 * D)))).epsilon(0.06));
        for (const DeviationBin& bin : lag.bins)
            if (bin.minus_rate.count > 0) {
                const double rate = v * v / (4.0 * D), density = 0.5 * std::log(rate * lag.lag / M_PI);
                const double truth = rate * std::pow(bin.W + 1.0, 2) - density / lag.lag;
                CHECK(bin.minus_rate.value == // bins: 1/108 of the part above the constant, plus 1/216 tau
                      Approx(truth).margin(5.0 * bin.minus_rate.error + 0.01 * (truth + density / lag.lag) +
                                           0.01 / lag.lag));
            }
    }
}

TEST_CASE("speed deviations: a kink of known size is found, and a straight antisymmetric part beside it") {
    double mean = 0.0;
    const std::vector<HeadingTrack> tracks = kinked(0.3, 1.0, mean);
    const SpeedDeviations r = speed_deviations(tracks, {10.0, 0.01}); // F is that of single steps
    REQUIRE(r.lags.size() == 1);
    const DeviationLag& lag = r.lags[0];
    CHECK(r.speed.value == Approx(v * mean).epsilon(0.02));
    CHECK(lag.slope.value == Approx(-2.0 * 0.3 * mean / step).epsilon(0.03));
    CHECK(std::abs(lag.cubic.value) < 4.0 * lag.cubic.error);
    CHECK(lag.kink.value == Approx(2.0 * mean / step).epsilon(0.03));
    CHECK(lag.kink.value > 20.0 * lag.kink.error);
    CHECK(lag.slope.value < 1.05 * lag.gaussian_slope); // not that of a Gaussian of its variance
}

TEST_CASE("speed deviations: an antisymmetric part that is not straight is seen to be so") {
    std::vector<HeadingTrack> tracks;
    for (std::size_t i = 0; i < 16; ++i) {
        RandomStream random(700 + i);
        Normal normal(800 + i);
        tracks.push_back(walked(200.0, [&] { // hops: ln P(x)/P(-x) is straight for neither of two widths
            return v * step * (random.uniform() < 0.3 ? 3.0 + 0.8 * normal() : 2.0 * normal());
        }));
    }
    const SpeedDeviations r = speed_deviations(tracks, {10.0, 0.01});
    CHECK(std::abs(r.lags[0].cubic.value) > 8.0 * r.lags[0].cubic.error);
}

TEST_CASE("speed deviations: errors of blocks are those of runs; one block has none") {
    const DeviationLag runs = speed_deviations(gaussian(40, 20.0, 100), options).lags[2],
                       blocks = speed_deviations(gaussian(2, 400.0, 200), options).lags[2];
    CHECK(runs.slope.error == Approx(blocks.slope.error).epsilon(0.6)); // 40 parts each: 11 % and more
    CHECK(runs.slope.value ==
          Approx(blocks.slope.value).margin(4.0 * std::hypot(runs.slope.error, blocks.slope.error)));
    const SpeedDeviations one = speed_deviations(gaussian(1, 8.0, 300), options);
    CHECK(one.parts == 1);
    CHECK_FALSE(one.lags[0].slope.known());
    CHECK(one.lags[0].slope.count == 1);
}

TEST_CASE("speed deviations: what cannot serve is refused, what never goes back has no slope") {
    const auto refused = [](const std::vector<HeadingTrack>& runs, const DeviationOptions& o,
                            const char* why) { CHECK_THROWS_WITH(speed_deviations(runs, o), Contains(why)); };
    refused({}, options, "speed_deviations: no runs");
    refused(gaussian(1, 20.0, 1), {0.5, 0.32}, "blocks twice as long as lags");
    refused(gaussian(1, 20.0, 1), {10.0, -1.0}, "must be positive");
    refused(gaussian(1, 0.5, 1), options, "lags up to 0.32 s need twice as much");
    refused(gaussian(8, 20.0, 1, 0.0), options, "not above 0 by three errors");
    refused(gaussian(8, 20.0, 1, -v), options, "not above 0 by three errors");
    refused(gaussian(1, 20.0, 1), {10.0, 0.004}, "no lag up to 0.004 s");
    refused({walked(20.0, [] { return v * step; })}, options, "its speed does not deviate");
    std::vector<HeadingTrack> uneven = gaussian(1, 20.0, 1);
    uneven[0].time[200] += 0.001;
    refused(uneven, options, "goes by even steps of time");
    std::vector<HeadingTrack> missing = gaussian(1, 20.0, 1); // a film without some of its frames
    for (auto part : {&HeadingTrack::time, &HeadingTrack::x, &HeadingTrack::y, &HeadingTrack::heading})
        (missing[0].*part).erase((missing[0].*part).begin() + 300);
    CHECK(speed_deviations(missing, options).speed.value == Approx(v).epsilon(0.1));
    const SpeedDeviations fast = speed_deviations(gaussian(8, 20.0, 1, 20.0 * v), options);
    CHECK(fast.told == fast.lags.size());
    for (const DeviationLag& lag : fast.lags) {
        CHECK(lag.slope.count == 0);
        CHECK(lag.backwards == 0.0);
    }
}
