// The field solves its equation and carries the force it should.

#include "sample.hpp"
#include "stencil.hpp"

#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;

namespace {

constexpr FieldRequest everything{true, true, true, true, true};

/// |-(1/xi) d_x U - lap U - eta grad div U| over the sum of its parts. d_x U_x is in the strain, d_x U_y is
/// taken by differences of the displacement.
double residual(const Field& field, double x, double y, double claimed_eta) {
    const Medium& m = field.medium();
    const FieldValues f = field.at(x, y, everything);
    const double length = std::min(std::hypot(x, y), m.xi / std::max(1.0, m.nu()));
    const auto uy = [&](double h) { return field.at(x + h, y, everything).displacement.y; };
    const double uy_x = oracle::difference_quotient(uy, length / 64.0);
    const double part[] = {f.strain.xx / m.xi, f.laplacian.x, claimed_eta * f.gradient_of_trace.x,
                           uy_x / m.xi,        f.laplacian.y, claimed_eta * f.gradient_of_trace.y};
    double scale = 0.0;
    for (const double p : part)
        scale += std::abs(p);
    return std::hypot(part[0] + part[1] + part[2], part[3] + part[4] + part[5]) / scale;
}

/// Momentum that leaves a circle: -(oint) [U n_x/xi + 2 eps n + (eta - 1) tr eps n] ds; the equation is its
/// divergence.
Vector force_inside(const Field& field, double radius, int points) {
    const Medium& m = field.medium();
    Vector sum;
    for (int k = 0; k < points; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + 0.25) / points, nx = std::cos(angle),
                     ny = std::sin(angle);
        const FieldValues f = field.at(radius * nx, radius * ny, everything);
        const double spread = (m.eta - 1.0) * (f.strain.xx + f.strain.yy);
        sum.x -= f.displacement.x * nx / m.xi + 2.0 * (f.strain.xx * nx + f.strain.xy * ny) + spread * nx;
        sum.y -= f.displacement.y * nx / m.xi + 2.0 * (f.strain.xy * nx + f.strain.yy * ny) + spread * ny;
    }
    const double ds = 2.0 * std::numbers::pi * radius / points;
    return {sum.x * ds, sum.y * ds};
}

} // namespace

TEST_CASE("the field solves the medium's equation") {
    RandomStream random(51);
    for (int k = 0; k < 500; ++k) {
        const double eta = k % 3 == 0 ? random.uniform(-0.9, 0.0) : random.log_uniform(1e-6, 1e6);
        const double xi = random.log_uniform(1e-6, 1e6), r = xi * random.log_uniform(1e-12, 20.0);
        const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
        const Field field({.eta = eta, .xi = xi});
        CAPTURE(eta, xi, r, angle);
        // Differences of U_y: (1/64)^8 9!/630 = 2e-12 of U_y/length, which is at most 5 times the sum of the
        // parts.
        CHECK(residual(field, r * std::cos(angle), r * std::sin(angle), eta) <= 1e-11);
    }
}

TEST_CASE("the residual of a wrong equation is seen") {
    const Field field({.eta = 1.3, .xi = 2.0});
    CHECK(residual(field, 0.7, -0.4, 1.3 * (1.0 + 1e-8)) > 1e-10); // eta off by 1e-8
}

TEST_CASE("a circle around the rod holds a unit force along x") {
    for (const double eta : {-0.5, 0.0, 1e-3, 1.3, 1e3})
        for (const double radius : {1e-9, 1e-3, 0.1, 1.0, 3.0}) {
            const Field field({.eta = eta, .xi = 1.0});
            const Vector force = force_inside(field, radius, 64);
            CAPTURE(eta, radius);
            CHECK(std::abs(force.x - 1.0) <
                  1e-10);                     // trapezoid: exponential in 64 points; rounding eta 1e-16 x 64
            CHECK(std::abs(force.y) < 1e-10); // the same
        }
}

TEST_CASE("the force on a circle can be wrong") {
    const Field field({.eta = 1.3, .xi = 1.0});
    CHECK(std::abs(force_inside(field, 1.0, 3).x - 1.0) > 1e-6);    // three points are too few
    CHECK(std::abs(force_inside(field, 400.0, 16).x - 1.0) > 1e-6); // the wake is narrow
}
