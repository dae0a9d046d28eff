// The smooth transform against closed forms, and the range of s in which it is called good.

#include "catch2/catch.hpp"
#include "known_motion.hpp"
#include "measure/laplace.hpp"
#include "measure/stiffness_spectrum.hpp"
#include "rodwake/core/error.hpp"

#include <limits>

using namespace rodwake;
using namespace rodwake::measure;
using synthetic::KnownMotion;

namespace {

using Row = std::vector<double>;

/// Lags in steps: 1..16, then 8 more an octave.
std::vector<std::size_t> lags(int octaves) {
    std::vector<std::size_t> all;
    for (std::size_t c = 1; c <= 16; ++c)
        all.push_back(c);
    for (int k = 1; k <= octaves; ++k)
        for (std::size_t c = 9; c <= 16; ++c)
            all.push_back(c << k);
    return all;
}

struct Curve {
    Row lag, msd;
    Curve(const KnownMotion& motion, double interval, int octaves) {
        const std::vector<std::size_t> steps = lags(octaves);
        const Row all = synthetic::exact_msd(motion, interval, steps.back());
        for (const std::size_t n : steps) {
            lag.push_back(interval * static_cast<double>(n));
            msd.push_back(all[n - 1]);
        }
    }
    StiffnessSpectrum spectrum() const {
        return spectrum_of(lag, msd, log_range(1.0 / lag.back(), 1.0 / lag.front(), 60));
    }
};

const KnownMotion underdamped{20.0, 6.5e-4, 0.0}, // 30 1/s
    overdamped{1000.0, 6.5e-4, 0.0},              // decays within 1.1 s
    maxwell{100.0, 6.5e-4, 1.0};

struct Off {
    double inside = 0.0, outside = 0.0; ///< largest share that the curve is off
    double over_bias = 0.0;             ///< largest error in parts of the stated bias, inside
};

Off off(const KnownMotion& motion, const StiffnessSpectrum& spectrum) {
    Off found;
    const double factor = 4.0 * KnownMotion::mass * KnownMotion::temperature;
    for (std::size_t i = 0; i < spectrum.s.size(); ++i) {
        const double s = spectrum.s[i], truth = motion.total(s) / factor;
        const double share = std::abs(spectrum.value[i] / truth - 1.0);
        const bool in = spectrum.low && s >= *spectrum.low && s <= *spectrum.high;
        (in ? found.inside : found.outside) = std::max(in ? found.inside : found.outside, share);
        if (in) // 1e-4 of the value: curves whose readings all agree still have the cubics' own error
            found.over_bias = std::max(found.over_bias, share * truth / (spectrum.bias[i] + 1e-4 * truth));
    }
    return found;
}

} // namespace

TEST_CASE("power laws are transformed exactly, below the first lag, too", "[smooth_laplace]") {
    for (const double p : {0.3, 1.0, 1.7, 2.0})
        for (const Between between : {Between::cubics, Between::power_laws}) {
            Row t, f;
            for (const std::size_t n : lags(9)) {
                t.push_back(0.1 * static_cast<double>(n));
                f.push_back(3.0 * std::pow(t.back(), p));
            }
            const SmoothSampled smooth = smooth_sampled(t, f, between);
            CHECK(smooth.start_exponent == Approx(p).epsilon(1e-12)); // round-off
            for (const double s : {0.05, 0.5, 10.0}) // exp(-s t_max) = 1e-18 and less: no tail
                CHECK(laplace(smooth, s) ==
                      Approx(3.0 * std::tgamma(p + 1.0) / std::pow(s, p + 1.0)).epsilon(1e-11));
        }
}

TEST_CASE("a bound bead's transform is better than that by straight lines", "[smooth_laplace]") {
    const Curve curve(overdamped, 0.1, 7);
    const double s = 1.0,
                 truth = 4.0 * KnownMotion::mass * KnownMotion::temperature / (s * overdamped.total(s));
    const double smooth = laplace(smooth_sampled(curve.lag, curve.msd, Between::cubics), s) / truth - 1.0;
    const double straight = laplace(sampled(curve.lag, curve.msd), s) / truth - 1.0;
    CAPTURE(smooth, straight);
    CHECK(std::abs(smooth) < 0.3 * std::abs(straight));
}

TEST_CASE("inside the range the transform is off by no more than its bias, outside by more than 2 %",
          "[smooth_laplace]") {
    for (const auto& [motion, interval] : {std::pair{underdamped, 0.002},
                                           {underdamped, 0.02},
                                           {overdamped, 0.05},
                                           {overdamped, 0.5},
                                           {maxwell, 0.005},
                                           {maxwell, 0.05}}) {
        const StiffnessSpectrum spectrum = Curve(motion, interval, 7).spectrum();
        REQUIRE(spectrum.low);
        const Off found = off(motion, spectrum);
        CAPTURE(motion.drag, motion.relaxation, interval, *spectrum.low, *spectrum.high, found.inside,
                found.outside, found.over_bias);
        CHECK(found.inside < StiffnessSpectrum::largest_bias);
        CHECK(found.over_bias < 1.0);
        CHECK(*spectrum.high > 0.15 / interval); // the range is not empty for fear
        CHECK(*spectrum.low < 5.0 / (interval * 2048.0));
    }
}

TEST_CASE("frames that miss how a bead moves end the range, and beyond it the curve is off",
          "[smooth_laplace]") {
    // Lags of 0.2 s and more: the oscillation, 0.2 s long, is over before the first lag.
    const StiffnessSpectrum coarse = Curve(underdamped, 0.2, 7).spectrum();
    REQUIRE(coarse.low);
    CHECK(*coarse.high < 2.0);
    CHECK(off(underdamped, coarse).outside > 2.0 * StiffnessSpectrum::largest_bias);
    // A run too short for the Maxwell element to let go: the plateau is followed by a slope that is not seen.
    const Curve brief(maxwell, 0.005, 2);
    const StiffnessSpectrum early = brief.spectrum();
    REQUIRE(early.low);
    CHECK(*early.low > 1.2 / brief.lag.back());
    CHECK(off(maxwell, early).outside > 2.0 * StiffnessSpectrum::largest_bias);
}

TEST_CASE("a curve that is good nowhere has no range", "[smooth_laplace]") {
    const Row t = {1.0, 2.0}, f = {1.0, 3.0};
    const StiffnessSpectrum spectrum = spectrum_of(t, f, {0.5, 0.7, 1.0});
    CHECK_FALSE(spectrum.low);
    CHECK_FALSE(spectrum.high);
}

TEST_CASE("smooth transforms refuse what they cannot take", "[smooth_laplace]") {
    CHECK_THROWS_AS(smooth_sampled(Row{1.0, 2.0}, Row{0.0, 1.0}, Between::cubics), InputError);
    CHECK_THROWS_AS(smooth_sampled(Row{1.0, 2.0}, Row{-1.0, 1.0}, Between::cubics), InputError);
    CHECK_THROWS_AS(smooth_sampled(Row{2.0, 1.0}, Row{1.0, 1.0}, Between::cubics), InputError);
    const SmoothSampled smooth = smooth_sampled(Row{1.0, 2.0}, Row{1.0, 2.0}, Between::cubics);
    for (const double s : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        CHECK_THROWS_AS(laplace(smooth, s), InputError);
}
