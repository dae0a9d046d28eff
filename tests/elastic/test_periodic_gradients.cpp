// Gradients of the field of a periodic box.

#include "periodic_cases.hpp"
#include "stencil.hpp"

#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldRequest;
using elastic::FieldValues;
using elastic::PeriodicField;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double headings[] = {0.0, 0.3, pi / 4, 1.2, pi / 2, 3.0, -2.2};
constexpr FieldRequest with_gradients{.strain = true, .polar = true, .gradients = true};
constexpr double promised = 1e-9; // periodic.hpp

/// The gradients by x in the places of what they are gradients of; the rest is 0.
FieldValues by_x(const FieldValues& f) {
    return {.displacement = {},
            .strain = f.strain_x,
            .laplacian = f.laplacian_x,
            .gradient_of_trace = f.gradient_of_trace_x,
            .dipole = {},
            .strain_x = {},
            .strain_y = {},
            .laplacian_x = {},
            .laplacian_y = {},
            .gradient_of_trace_x = {},
            .gradient_of_trace_y = {}};
}

FieldValues by_y(const FieldValues& f) {
    FieldValues g = f;
    g.strain_x = f.strain_y;
    g.laplacian_x = f.laplacian_y;
    g.gradient_of_trace_x = f.gradient_of_trace_y;
    return by_x(g);
}

/// The worst of both directions against the largest gradient at that distance.
double error_of(const PeriodicField& field, double x, double y, const FieldValues& exact) {
    const FieldValues got = field.at(x, y, with_gradients);
    const Norms scale = largest_on_circle(std::hypot(x, y), [&](double u, double v) {
        const FieldValues f = field.at(u, v, with_gradients);
        Norms n = norms(by_x(f));
        const Norms m = norms(by_y(f));
        for (std::size_t q = 0; q < n.size(); ++q)
            n[q] = std::max(n[q], m[q]);
        return n;
    });
    const auto one = [&](const FieldValues& a, const FieldValues& b) {
        double w = 0.0;
        const Norms d = distances(a, b);
        for (const std::size_t q : {1, 2, 3})
            w = std::max(w, d[q] / scale[q]);
        return w;
    };
    return std::max(one(by_x(got), by_x(exact)), one(by_y(got), by_y(exact)));
}

/// A random case: near and far, small and large boxes, soft and stiff media.
BoxPoint sample(RandomStream& random, int k, double largest_ratio) {
    const double box = random.log_uniform(1e-2, 1e2), ratio = random.log_uniform(1e-3, largest_ratio);
    const double eta = k % 11 == 0 ? random.uniform(-0.5, 0.0) : random.log_uniform(1e-3, 1e3);
    const double r = k % 3 ? random.uniform(0.02, 0.7) : random.log_uniform(1e-2, 0.5),
                 angle = random.uniform(-pi, pi);
    return {r * box * std::cos(angle), r * box * std::sin(angle), box / ratio, eta, box, headings[k % 7]};
}

PeriodicField field_of(const BoxPoint& p) { return {{.eta = p.eta, .xi = p.xi}, p.box, p.heading}; }

} // namespace

TEST_CASE("gradients of the periodic field agree with Ewald's sums") {
    RandomStream random(101);
    for (int k = 0; k < 140; ++k) {
        const BoxPoint p = sample(random, k, 100.0);
        CAPTURE(k, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        const FieldValues exact = periodic_field(p);
        const double e = error_of(field_of(p), p.x, p.y, exact);
        CHECK(e < promised);
        FieldValues wrong = exact;
        wrong.strain_y.xx *= 1.0 + 1e-4;
        wrong.strain_y.xy += 1e-7 * norms(by_x(exact))[1];
        CHECK(error_of(field_of(p), p.x, p.y, wrong) > 1e-10);
    }
}

TEST_CASE("gradients of the periodic field are those of its own differences, up to 1000 screening lengths") {
    RandomStream random(102);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, k, 1e3);
        const PeriodicField field = field_of(p);
        const double r = std::hypot(p.x, p.y);
        const double fastest = 0.5 / p.xi * std::max(1.0, field.medium().nu());
        const double step = 0.02 * std::min({r, 0.3 * p.box, 1.0 / fastest}); // images: 0.3 away and more
        const auto slope = [&](auto part, double u, double v) {
            return difference_quotient(
                [&](double h) { return part(field.at(p.x + u * h, p.y + v * h, plain)); }, step);
        };
        const auto xy = [](const FieldValues& f) { return f.strain.xy; };
        const auto trace_y = [](const FieldValues& f) { return f.gradient_of_trace.y; };
        const FieldValues f = field.at(p.x, p.y, with_gradients);
        const Norms n = norms(by_x(f)), m = norms(by_y(f)), whole = largest_at(field, r);
        CAPTURE(k, p.box / p.xi, p.eta, p.heading, r / p.box);
        // 1e-11: the field's 1e-13 over steps of a 50th
        const double strain = promised * (n[1] + m[1]) + 1e-11 * whole[1] / (50.0 * step),
                     trace = promised * (n[3] + m[3]) + 1e-11 * whole[3] / (50.0 * step);
        CHECK(std::abs(slope(xy, 1.0, 0.0) - f.strain_x.xy) < strain);
        CHECK(std::abs(slope(xy, 0.0, 1.0) - f.strain_y.xy) < strain);
        CHECK(std::abs(slope(trace_y, 1.0, 0.0) - f.gradient_of_trace_x.y) < trace);
        CHECK(std::abs(slope(trace_y, 0.0, 1.0) - f.gradient_of_trace_y.y) < trace);
    }
}

TEST_CASE("gradients of the periodic field obey the differentiated equation and compatibility") {
    RandomStream random(103);
    for (int k = 0; k < 140; ++k) {
        const BoxPoint p = sample(random, k, 1e3);
        const FieldValues f = field_of(p).at(p.x, p.y, with_gradients);
        const double uy_xx = 2.0 * f.strain_x.xy - f.strain_y.xx, ux_yy = 2.0 * f.strain_y.xy - f.strain_x.yy;
        CAPTURE(k, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        const auto small = [](std::initializer_list<double> parts, double of_sum) {
            double sum = 0.0, size = 0.0;
            for (const double part : parts) {
                sum += part;
                size += std::abs(part);
            }
            return std::abs(sum) < of_sum * size;
        };
        // 1e-10: U of a small box is made of parts xi/L times as large
        CHECK(small({uy_xx / p.xi, f.laplacian_x.y, p.eta * f.gradient_of_trace_x.y}, 1e-10));
        CHECK(small({ux_yy, f.strain_x.xx, -f.laplacian.x}, 1e-10));
        CHECK(small({uy_xx, f.strain_y.yy, -f.laplacian.y}, 1e-10));
        CHECK(small({f.strain_x.xx, f.strain_x.yy, -f.gradient_of_trace.x}, 1e-10));
        CHECK(small({f.strain_y.xx, f.strain_y.yy, -f.gradient_of_trace.y}, 1e-10));
    }
}

TEST_CASE("gradients of the periodic field repeat") {
    RandomStream random(104);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, k, 1e3);
        const PeriodicField field = field_of(p);
        const elastic::Vector shift = to_rod(p.heading, 2.0 * p.box, -3.0 * p.box);
        CAPTURE(k, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        // rounding of the place, 3 of 16 digits times the box over the distance from the rod
        CHECK(error_of(field, p.x, p.y, field.at(p.x + shift.x, p.y + shift.y, with_gradients)) < 1e-10);
    }
}

TEST_CASE("gradients of the field in a large box are the infinite plane's") {
    const elastic::Medium medium{.eta = 1.0, .xi = 1.0};
    const PeriodicField field(medium, 400.0, 0.3);
    const FieldValues got = field.at(0.5, 1.0, with_gradients),
                      wanted = elastic::Field(medium).at(0.5, 1.0, with_gradients);
    // The images' wakes are sqrt(xi/L)/2 pi = 8e-3 of U and 2 sqrt(xi L) = 40 wide
    CHECK(distances(by_y(got), by_y(wanted))[1] < 1e-5);
    CHECK(distances(by_x(got), by_x(wanted))[2] < 1e-5);
    CHECK(norms(by_y(wanted))[1] > 1e-2);
}

TEST_CASE("gradients change nothing else, and come as wanted") {
    const PeriodicField field({}, 2.0, 0.3);
    for (const double x : {0.2, 0.8}) {
        const FieldValues all = field.at(x, 0.1, with_gradients),
                          strain = field.at(x, 0.1, {.strain = true, .gradients = true}),
                          without = field.at(x, 0.1, {.strain = true, .polar = true});
        CHECK(without.strain.xx == all.strain.xx);
        CHECK(without.laplacian.y == all.laplacian.y);
        CHECK(std::isnan(without.strain_x.xx));
        CHECK(strain.strain_y.xy == all.strain_y.xy);
        CHECK(std::isnan(strain.laplacian_x.x));
        CHECK(std::isnan(all.dipole.x));
    }
    CHECK(std::isfinite(field.at_own_place(with_gradients).strain_x.xy));
}
