// Principal axes, checked by multiplying them out.

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

/// |T v - lambda v| of the traceless part T, over |T|.
double defect(const SymmetricTensor& t, double value, double angle) {
    const double half = 0.5 * (t.xx - t.yy), c = std::cos(angle), s = std::sin(angle);
    const double x = half * c + t.xy * s - value * c, y = t.xy * c - half * s - value * s;
    return std::hypot(x, y) / std::hypot(half, t.xy);
}

} // namespace

TEST_CASE("the extensional axis is an eigenvector, the other one perpendicular") {
    RandomStream random(81);
    for (int k = 0; k < 1000; ++k) {
        const double scale = random.log_uniform(1e-150, 1e150);
        const auto part = [&] { return scale * random.uniform(-1.0, 1.0); };
        const SymmetricTensor t{part(), part(), part()};
        const PrincipalAxis axis = extensional_axis(t);
        CHECK(axis.value >= 0.0);
        CHECK((axis.angle > -std::numbers::pi / 2 && axis.angle <= std::numbers::pi / 2));
        CHECK(defect(t, axis.value, axis.angle) < 1e-15 * 4.0); // rounding of cos and sin
        CHECK(defect(t, -axis.value, axis.angle + std::numbers::pi / 2) < 1e-15 * 4.0); // the same
    }
}

TEST_CASE("simple tensors have the axes they should") {
    CHECK(extensional_axis({1.0, 0.0, -1.0}).angle == 0.0);
    CHECK(extensional_axis({-1.0, 0.0, 1.0}).angle ==
          Approx(std::numbers::pi / 2).epsilon(1e-15)); // one rounding
    CHECK(extensional_axis({0.0, 1.0, 0.0}).angle == Approx(std::numbers::pi / 4).epsilon(1e-15)); // the same
    CHECK(extensional_axis({0.0, -1.0, 0.0}).angle == Approx(-std::numbers::pi / 4).epsilon(1e-15));
    CHECK(extensional_axis({3.0, 0.0, 3.0}).value == 0.0);
    CHECK(extensional_axis({3.0, 0.0, 3.0}).angle == 0.0);
    CHECK(extensional_axis({5.0, 0.0, 3.0}).value == 1.0);
}

TEST_CASE("the zero of the contraction counts as the upper end of the range") {
    // xy = -0 must not give -pi/2: the header's range is (-pi/2, pi/2].
    CHECK(extensional_axis({-1.0, -0.0, 1.0}).angle ==
          Approx(std::numbers::pi / 2).epsilon(1e-15)); // one rounding
    CHECK(extensional_axis({0.0, -0.0, 0.0}).angle == 0.0);
    CHECK(extensional_axis({-0.0, 0.0, 0.0}).angle == 0.0);
}

TEST_CASE("a wrong axis has a defect") {
    CHECK(defect({1.0, 0.2, -1.0}, extensional_axis({1.0, 0.2, -1.0}).value, 0.5) > 0.1);
}
