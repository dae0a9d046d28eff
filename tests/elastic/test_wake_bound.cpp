// Bounds of a rod's field: never below it, and not idle.

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"
#include "rodwake/elastic/wake_bound.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

struct Norms {
    double strain, polar;
};

Norms norms_at(const Medium& medium, double x, double y) {
    const FieldValues f = Field(medium).at(x, y, {.strain = true, .polar = true});
    const SymmetricTensor& e = f.strain;
    return {std::sqrt(e.xx * e.xx + 2.0 * e.xy * e.xy + e.yy * e.yy),
            std::max(std::hypot(f.laplacian.x, f.laplacian.y),
                     std::hypot(f.gradient_of_trace.x, f.gradient_of_trace.y))};
}

/// r + x, by y^2/(r - x) behind.
double ahead(double r, double x, double y) { return x > 0.0 ? r + x : y * y / (r - x); }

} // namespace

TEST_CASE("no field is above its bound, there or nearer to the rod and its wake") {
    RandomStream random(51);
    for (int k = 0; k < 60000; ++k) {
        const Medium medium{k % 5 == 0 ? random.uniform(-0.9, 0.0) : random.log_uniform(1e-3, 1e3),
                            random.log_uniform(0.1, 10.0)};
        const double r = medium.xi * random.log_uniform(1e-3, 1e4);
        const double angle =
            k % 2 == 0 ? random.uniform(-3.2, 3.2)
                       : std::numbers::pi + random.uniform(-1.0, 1.0) * random.log_uniform(1e-6, 1.0);
        const double x = r * std::cos(angle), y = r * std::sin(angle), w = ahead(r, x, y);
        const Norms norms = norms_at(medium, x, y);
        const WakeBound bound(medium);
        CAPTURE(medium.eta, medium.xi, r, angle);
        REQUIRE(norms.strain <= bound.strain(r, w));
        REQUIRE(norms.polar <= bound.polar(r, w));
        const double r0 = r * random.uniform(0.01, 1.0), w0 = w * random.uniform(0.0, 1.0);
        REQUIRE(bound.strain(r0, w0) >= bound.strain(r, w)); // falls with both
        REQUIRE(bound.polar(r0, w0) >= bound.polar(r, w));
    }
}

TEST_CASE("far away the bounds are within a factor of the field") {
    for (const double eta : {0.3, 1.0, 10.0})
        for (const double r : {20.0, 200.0, 2000.0}) {
            const Medium medium{eta, 1.0};
            double strain = 0.0, polar = 0.0; // largest of a circle
            for (int k = 0; k < 20000; ++k) {
                const double angle = std::numbers::pi * (1.0 - 1e-6 * std::pow(1e6, k / 20000.0));
                const Norms norms = norms_at(medium, r * std::cos(angle), r * std::sin(angle));
                strain = std::max(strain, norms.strain);
                polar = std::max(polar, norms.polar);
            }
            CAPTURE(eta, r);
            CHECK(WakeBound(medium).strain(r, 0.0) < 12.0 * strain);
            CHECK(WakeBound(medium).polar(r, 0.0) < 12.0 * polar);
        }
}

TEST_CASE("ahead the bounds decay as the field does") {
    const Medium medium{1.0, 1.0};
    const double near = WakeBound(medium).strain(20.0, 40.0) / norms_at(medium, 20.0, 0.0).strain,
                 far = WakeBound(medium).strain(200.0, 400.0) / norms_at(medium, 200.0, 0.0).strain;
    CHECK(far < 12.0);
    CHECK(near < 12.0); // without the exponent it would be 1e4 and 1e43
}

TEST_CASE("bounds refuse an illegal medium") { CHECK_THROWS_AS(WakeBound({-1.0, 1.0}), InputError); }
