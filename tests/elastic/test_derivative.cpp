// The quantities are derivatives of one another, and solve the medium's equation, over random points and
// media.

#include "stencil.hpp"

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

using namespace rodwake;
using namespace rodwake::elastic;
using oracle::difference_quotient;

namespace {

constexpr FieldRequest everything{true, true, true, true, true};

/// Step h = a 64th of the shortest length on which the field changes: truncation (1/64)^8 9!/630 = 2e-12 of
/// f/length, rounding 64 eps = 1.4e-14 of it, and terms up to ten lengths apart in size.
constexpr double tolerance = 3e-11;

struct Case {
    Field field;
    double x, y, step;
    FieldValues at(double dx, double dy) const { return field.at(x + dx, y + dy, everything); }
};

Case random_case(RandomStream& random) {
    const double eta = random.uniform() < 0.3 ? random.uniform(-0.8, 0.0) : random.log_uniform(1e-3, 1e3);
    const double xi = random.log_uniform(1e-2, 1e2), r = xi * random.log_uniform(1e-6, 20.0);
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    const Medium medium{.eta = eta, .xi = xi};
    const double length = std::min(r, xi / std::max(1.0, medium.nu()));
    return {Field(medium), r * std::cos(angle), r * std::sin(angle), length / 64.0};
}

template<class Part>
double d_x(const Case& c, Part part) {
    return difference_quotient([&](double h) { return part(c.at(h, 0.0)); }, c.step);
}
template<class Part>
double d_y(const Case& c, Part part) {
    return difference_quotient([&](double h) { return part(c.at(0.0, h)); }, c.step);
}

double size(const SymmetricTensor& t) { return std::hypot(t.xx, std::hypot(t.xy, t.yy)); }
double size(const Vector& v) { return std::hypot(v.x, v.y); }

/// Largest value a difference of f at this step can be wrong by.
double allowed(const Case& c, double value) { return tolerance * value / (64.0 * c.step); }

} // namespace

TEST_CASE("the difference quotient has its order and can fail") {
    const auto error = [](double h) {
        return std::abs(difference_quotient([](double t) { return std::exp(t); }, h) - 1.0);
    };
    CHECK(error(0.5) ==
          Approx(std::pow(0.5, 8) / 630.0).epsilon(0.1)); // next term: h^2/4 = 6 % of the leading one
    CHECK(error(0.05) < 1e-13);                           // 6e-14 truncation
    CHECK(error(1.0) > 1e-3);
}

TEST_CASE("strain is the symmetric gradient of the displacement") {
    RandomStream random(41);
    for (int k = 0; k < 300; ++k) {
        const Case c = random_case(random);
        const FieldValues f = c.at(0.0, 0.0);
        const auto ux = [](const FieldValues& v) { return v.displacement.x; };
        const auto uy = [](const FieldValues& v) { return v.displacement.y; };
        const double bound = allowed(c, size(f.displacement)) + tolerance * size(f.strain);
        CAPTURE(c.x, c.y, c.field.medium().xi, c.field.medium().eta);
        CHECK(std::abs(d_x(c, ux) - f.strain.xx) <= bound);
        CHECK(std::abs(d_y(c, uy) - f.strain.yy) <= bound);
        CHECK(std::abs(0.5 * (d_y(c, ux) + d_x(c, uy)) - f.strain.xy) <= bound);
        CHECK(std::abs(d_x(c, ux) + d_y(c, uy) - (f.strain.xx + f.strain.yy)) <= bound); // div u = tr eps
    }
}

TEST_CASE("lap u and grad div u are derivatives of the strain") {
    RandomStream random(42);
    for (int k = 0; k < 300; ++k) {
        const Case c = random_case(random);
        const FieldValues f = c.at(0.0, 0.0);
        const auto xx = [](const FieldValues& v) { return v.strain.xx; };
        const auto xy = [](const FieldValues& v) { return v.strain.xy; };
        const auto yy = [](const FieldValues& v) { return v.strain.yy; };
        const double bound =
            6.0 * allowed(c, size(f.strain)) + tolerance * size(f.strain_x); // up to five terms
        CAPTURE(c.x, c.y, c.field.medium().xi, c.field.medium().eta);
        CHECK(std::abs(d_x(c, xx) + d_x(c, yy) - f.gradient_of_trace.x) <= bound);
        CHECK(std::abs(d_y(c, xx) + d_y(c, yy) - f.gradient_of_trace.y) <= bound);
        CHECK(std::abs(d_x(c, xx) + 2.0 * d_y(c, xy) - d_x(c, yy) - f.laplacian.x) <= bound);
        CHECK(std::abs(d_y(c, yy) + 2.0 * d_x(c, xy) - d_y(c, xx) - f.laplacian.y) <= bound);
    }
}

TEST_CASE("gradients are derivatives of strain and of the polar vectors") {
    RandomStream random(43);
    for (int k = 0; k < 200; ++k) {
        const Case c = random_case(random);
        const FieldValues f = c.at(0.0, 0.0);
        CAPTURE(c.x, c.y, c.field.medium().xi, c.field.medium().eta);
        const auto check = [&](auto part, double x_slope, double y_slope, double value, double slope) {
            const double bound = allowed(c, value) + tolerance * slope;
            CHECK(std::abs(d_x(c, part) - x_slope) <= bound);
            CHECK(std::abs(d_y(c, part) - y_slope) <= bound);
        };
        const double strain = size(f.strain), strain_slope = size(f.strain_x) + size(f.strain_y);
        check([](const FieldValues& v) { return v.strain.xx; }, f.strain_x.xx, f.strain_y.xx, strain,
              strain_slope);
        check([](const FieldValues& v) { return v.strain.xy; }, f.strain_x.xy, f.strain_y.xy, strain,
              strain_slope);
        check([](const FieldValues& v) { return v.strain.yy; }, f.strain_x.yy, f.strain_y.yy, strain,
              strain_slope);
        const double lap = size(f.laplacian), grad = size(f.gradient_of_trace);
        const double lap_slope = size(f.laplacian_x) + size(f.laplacian_y);
        const double grad_slope = size(f.gradient_of_trace_x) + size(f.gradient_of_trace_y);
        check([](const FieldValues& v) { return v.laplacian.x; }, f.laplacian_x.x, f.laplacian_y.x, lap,
              lap_slope);
        check([](const FieldValues& v) { return v.laplacian.y; }, f.laplacian_x.y, f.laplacian_y.y, lap,
              lap_slope);
        check([](const FieldValues& v) { return v.gradient_of_trace.x; }, f.gradient_of_trace_x.x,
              f.gradient_of_trace_y.x, grad, grad_slope);
        check([](const FieldValues& v) { return v.gradient_of_trace.y; }, f.gradient_of_trace_x.y,
              f.gradient_of_trace_y.y, grad, grad_slope);
    }
}
