// The field solves its equation and carries the force it should.

#include "sample.hpp"
#include "stencil.hpp"

#include "rodwake/elastic/field.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <catch2/catch.hpp>

#include <algorithm>
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

// --- Near, far, soft and stiff: the limits of the field that are known on paper

namespace {

constexpr double pi = std::numbers::pi;

FieldValues at(double eta, double x, double y, double xi = 1.0) {
    return Field({.eta = eta, .xi = xi}).at(x, y, everything);
}

} // namespace

TEST_CASE("near the rod the field is Kelvin's, coefficient and constant") {
    // 2 pi U_x = (1 + nu)/2 [ln(4 xi/r) - gamma] - nu/2 ln nu + (1 - nu)/2 cos^2, 2 pi U_y = (1 - nu)/2 cos
    // sin
    for (const double eta : {-0.5, 0.0, 0.3, 1.0, 50.0})
        for (const double r : {1e-12, 1e-9})
            for (const double angle : {0.0, 0.7, 2.0, pi}) {
                const double nu = 1.0 / (1.0 + eta), xi = 3.0, c = std::cos(angle), s = std::sin(angle);
                const FieldValues f = at(eta, r * xi * c, r * xi * s, xi);
                const double ux = 0.5 * (1.0 + nu) * (std::log(4.0 / r) - std::numbers::egamma) -
                                  0.5 * nu * std::log(nu) + 0.5 * (1.0 - nu) * c * c;
                CAPTURE(eta, r, angle);
                CHECK(std::abs(2.0 * pi * f.displacement.x - ux) <
                      100.0 * r + 1e-14); // next order: r ln(r) nu^2
                CHECK(std::abs(2.0 * pi * f.displacement.y - 0.5 * (1.0 - nu) * c * s) <
                      100.0 * r + 1e-15); // the same
            }
}

TEST_CASE("ahead of the rod the field decays as its exponent says") {
    for (const double eta : {-0.5, 0.5, 4.0}) {
        const double slowest = std::min(1.0, 1.0 / (1.0 + eta)), x = 400.0;
        const FieldValues f = at(eta, x, 0.0);
        const double slope = f.strain.xx / f.displacement.x; // d ln U_x/dx
        const double power = eta > 0.0 ? 0.5 : 1.5; // on the axis the shear potential's first order cancels
        CAPTURE(eta);
        CHECK(std::abs(slope + slowest + power / x) <
              10.0 / (slowest * x * x)); // next order of the Bessel functions
    }
    for (const double angle : {0.3, 1.0, 2.0}) { // exponent nu (x + r)/(2 xi)
        const double nu = 0.5, r = 400.0, c = std::cos(angle), s = std::sin(angle);
        const double ratio =
            at(1.0, 2.0 * r * c, 2.0 * r * s).displacement.x / at(1.0, r * c, r * s).displacement.x;
        const double expected = -nu * r * (1.0 + c) / 2.0 - 0.5 * std::log(2.0);
        CHECK(std::abs(std::log(ratio) - expected) <
              10.0 / r); // next order of the Bessel functions, 1/(nu r)
    }
}

TEST_CASE("behind the rod the field falls as the square root of distance over three decades") {
    const auto log_ux = [](double x) { return std::log(at(1.3, -x, 0.0).displacement.x); };
    for (double x = 1e3; x <= 1e6; x *= 1.5) {
        const FieldValues f = at(1.3, -x, 0.0);
        CHECK(std::abs(-x * f.strain.xx / f.displacement.x + 0.5) <
              1e-3); // next order: xi/x = 1e-3 and a small factor
    }
    CHECK(std::abs((log_ux(1e6) - log_ux(1e3)) / std::log(1e3) + 0.5) < 1e-3); // the same
    CHECK(std::abs((log_ux(10.0) - log_ux(1.0)) / std::log(10.0) + 0.5) >
          1e-3); // and not yet so close to the rod
}

TEST_CASE("for eta -> 0 the field is the scalar potential along x") {
    for (const double x : {-7.0, -0.2, 0.4, 5.0})
        for (const double y : {-0.3, 2.0}) {
            const double k0 = std::exp(-0.5 * x) * boost::math::cyl_bessel_k(0, 0.5 * std::hypot(x, y));
            const FieldValues zero = at(0.0, x, y), soft = at(1e-9, x, y);
            CHECK(zero.displacement.x == Approx(k0 / (2.0 * pi)).epsilon(1e-14)); // a few ulp on either side
            CHECK(zero.displacement.y == 0.0);
            CHECK(std::abs(soft.displacement.x - zero.displacement.x) <
                  1e-8 * zero.displacement.x);                                 // order eta
            CHECK(std::abs(soft.displacement.y) < 1e-8 * zero.displacement.x); // order eta
        }
}

TEST_CASE("for eta -> infinity the divergence falls as nu") {
    for (const double x : {-3.0, 0.4, 2.0})
        for (const double y : {-0.7, 1.0}) {
            const double eta = 1e10, r2 = x * x + y * y;
            const FieldValues f = at(eta, x, y);
            const double trace = (f.strain.xx + f.strain.yy) * (1.0 + eta);
            // xx and yy cancel to 1e-10 of themselves, which leaves 1e-6; the next order in nu is smaller.
            CHECK(trace == Approx(-x / (2.0 * pi * r2)).epsilon(1e-5));
            const double gradient = f.gradient_of_trace.x * (1.0 + eta);
            CHECK(gradient ==
                  Approx((x * x - y * y) / (2.0 * pi * r2 * r2)).epsilon(1e-8)); // next order: nu ln nu
        }
}
