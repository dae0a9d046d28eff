// The Laplace transform of sampled functions against closed forms.

#include "catch2/catch.hpp"
#include "measure/laplace.hpp"
#include "rodwake/core/error.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

using Row = std::vector<double>;

/// Values at times 1..16, then 8 more an octave, as the multi-tau accumulator has them.
struct Samples {
    Row t, f;
    Samples(const std::function<double(double)>& function, double step, int octaves) {
        for (int c = 1; c <= 16; ++c)
            t.push_back(c * step);
        for (int k = 1; k <= octaves; ++k)
            for (int c = 9; c <= 16; ++c)
                t.push_back(c * step * std::pow(2.0, k));
        for (const double time : t)
            f.push_back(function(time));
    }
    double transform(double s) const { return laplace(sampled(t, f), s); }
};

} // namespace

TEST_CASE("a straight line's transform is exact, its tail included", "[laplace]") {
    const Samples line([](double t) { return 3.0 * t; }, 0.1, 5);
    for (const double s : {1e-6, 1e-3, 0.1, 1.0, 20.0, 500.0})
        CHECK(line.transform(s) == Approx(3.0 / (s * s)).epsilon(1e-12)); // round-off
}

TEST_CASE("a step's transform is that of the rising edge and the plateau", "[laplace]") {
    const Row t = {0.5, 1.0, 4.0}, f = {2.0, 2.0, 2.0};
    for (const double s : {1e-3, 0.3, 5.0}) {
        const double edge = 4.0 * (1.0 - (1.0 + 0.5 * s) * std::exp(-0.5 * s)) / (s * s);
        // at s = 1e-3 the closed form loses 1e-16/(s/2)^2 itself
        CHECK(laplace(sampled(t, f), s) == Approx(edge + 2.0 * std::exp(-0.5 * s) / s).epsilon(1e-9));
    }
}

TEST_CASE("a falling end is not continued below its last value", "[laplace]") {
    const Row t = {1.0, 2.0, 3.0}, f = {1.0, 3.0, 2.0};
    CHECK(sampled(t, f).tail_slope == 0.0); // the last two: -1
    const Row rising_end = {1.0, 2.0, 2.5};
    CHECK(sampled(t, rising_end).tail_slope == Approx(0.5).epsilon(1e-14));
    CHECK(sampled(Row{1.0, 10.0}, Row{1.0, 19.0}).tail_slope == Approx(2.0).epsilon(1e-14));
}

TEST_CASE("a bound bead's mean-square displacement is transformed to the order of its sampling",
          "[laplace]") {
    const double tau = 2.0;
    double off[2];
    for (const int fine : {0, 1}) {
        const Samples bound([&](double t) { return 1.0 - std::exp(-t / tau); }, fine ? 0.05 : 0.1, 7 + fine);
        off[fine] = bound.transform(0.2) * 0.2 * (1.0 + 0.2 * tau) - 1.0;
    }
    // Straight between points an eighth of their time apart: below the curve by up to (1/8)^2/8 of its bend.
    CHECK(std::abs(off[1]) < 2e-3);
    CHECK(off[1] < 0.0);
    CHECK(off[0] < 0.0);
}

TEST_CASE("series and closed form of the pieces meet", "[laplace]") {
    // One piece of width 1 from (0, 0) to (1, 1), then flat: s around 0.5, where the forms change.
    const Row t = {1.0, 2.0}, f = {1.0, 1.0};
    const double below = laplace(sampled(t, f), 0.5),
                 above = laplace(sampled(t, f), std::nextafter(0.5, 1.0));
    CHECK(above == Approx(below).epsilon(1e-14));
}

TEST_CASE("transforms refuse what they cannot take", "[laplace]") {
    const double none = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(sampled(Row{1.0}, Row{1.0}), InputError);
    CHECK_THROWS_AS(sampled(Row{1.0, 2.0}, Row{1.0}), InputError);
    CHECK_THROWS_AS(sampled(Row{0.0, 2.0}, Row{1.0, 1.0}), InputError);
    CHECK_THROWS_AS(sampled(Row{2.0, 2.0}, Row{1.0, 1.0}), InputError);
    CHECK_THROWS_AS(sampled(Row{1.0, 2.0}, Row{1.0, none}), InputError);
    const Row t = {1.0, 2.0}, f = {1.0, 2.0};
    for (const double s : {0.0, -1.0, none})
        CHECK_THROWS_AS(laplace(sampled(t, f), s), InputError);
}
