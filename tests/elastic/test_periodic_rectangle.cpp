// The field of a rod in a periodic rectangle: against Ewald's sums, and what boxes that hold one another say.

#include "periodic_cases.hpp"

#include "elastic/field_algebra.hpp"
#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldRequest;
using elastic::FieldValues;
using elastic::PeriodicField;
using elastic::Vector;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double headings[] = {0.0, 0.3, pi / 4, 1.2, pi / 2, 3.0, -2.2};
constexpr double promised = 1e-10; // periodic.hpp

/// Sides up to 4 times each other, from 1e-3 to `largest_ratio` screening lengths; soft and stiff media;
/// places near the rod and up to the far end of the box.
BoxPoint sample(RandomStream& random, int k, double largest_ratio) {
    BoxPoint p{};
    p.aspect = random.log_uniform(0.25, 4.0);
    p.box = random.log_uniform(1e-2, 1e2);
    const double longer = p.sides().longer(), shorter = p.sides().shorter();
    p.xi = longer / random.log_uniform(4e-3, largest_ratio);
    p.eta = k % 11 == 0 ? random.uniform(-0.5, 0.0) : random.log_uniform(1e-3, 1e3);
    p.heading = headings[k % 7];
    const double r = k % 3 ? random.uniform(0.02, 0.5) * longer : random.log_uniform(1e-2, 0.5) * shorter,
                 angle = random.uniform(-pi, pi);
    p.x = r * std::cos(angle);
    p.y = r * std::sin(angle);
    return p;
}

PeriodicField field_of(const BoxPoint& p) { return {{.eta = p.eta, .xi = p.xi}, p.sides(), p.heading}; }

/// Gradients by x or y as the quantities that they are gradients of.
FieldValues by_place(const FieldValues& f, bool by_x) {
    FieldValues g;
    g.strain = by_x ? f.strain_x : f.strain_y;
    g.laplacian = by_x ? f.laplacian_x : f.laplacian_y;
    g.gradient_of_trace = by_x ? f.gradient_of_trace_x : f.gradient_of_trace_y;
    return g;
}

/// Over how large an angle the field changes: a wave of the box over 2 pi xi/L, an image by its distance.
double angle_of_change(const BoxPoint& p) {
    const Vector at = elastic::turned(Vector{p.x, p.y}, std::cos(p.heading), std::sin(p.heading));
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = -5; i <= 5; ++i)
        for (int j = -5; j <= 5; ++j)
            if (i != 0 || j != 0)
                nearest = std::min(nearest, std::hypot(at.x - i * p.sides().x, at.y - j * p.sides().y));
    const double fastest = std::max(1.0, 1.0 / (1.0 + p.eta));
    return std::min({1.0, 2.0 * pi * p.xi / p.sides().longer() / fastest, nearest / std::hypot(p.x, p.y)});
}

Norms sum(Norms a, const Norms& b, double times) {
    for (std::size_t q = 0; q < a.size(); ++q)
        a[q] += times * b[q];
    return a;
}

} // namespace

TEST_CASE("the field of a periodic rectangle agrees with Ewald's sums") {
    RandomStream random(121);
    for (int k = 0; k < 140; ++k) {
        const BoxPoint p = sample(random, k, k % 4 ? 20.0 : 100.0);
        const PeriodicField field = field_of(p);
        const FieldValues exact = periodic_field(p);
        const Norms scale = largest_at(field, std::hypot(p.x, p.y));
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        CHECK(worst(distances(field.at(p.x, p.y, plain), exact), scale) < promised);
        FieldValues wrong = exact;
        wrong.laplacian.y += 1e-9 * scale[2];
        CHECK(worst(distances(field.at(p.x, p.y, plain), wrong), scale) > promised);
    }
}

TEST_CASE("gradients of the field of a periodic rectangle agree with Ewald's sums") {
    constexpr FieldRequest with_gradients{.strain = true, .polar = true, .gradients = true};
    RandomStream random(122);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, k, 60.0);
        const PeriodicField field = field_of(p);
        const FieldValues exact = periodic_field(p), got = field.at(p.x, p.y, with_gradients);
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        for (const bool by_x : {true, false}) {
            const Norms scale = largest_on_circle(std::hypot(p.x, p.y), [&](double x, double y) {
                const FieldValues f = field.at(x, y, with_gradients);
                return sum(norms(by_place(f, true)), norms(by_place(f, false)), 1.0);
            });
            const Norms d = distances(by_place(got, by_x), by_place(exact, by_x));
            for (const std::size_t q : {1, 2, 3})
                CHECK(d[q] < 1e-9 * scale[q]); // periodic.hpp
        }
    }
}

TEST_CASE("a rectangle's field changes with the heading as by differences of Ewald's sums") {
    RandomStream random(123);
    for (int k = 0; k < 28; ++k) {
        BoxPoint p = sample(random, k + 1, 60.0);
        p.x = p.x < 0.0 ? p.x - 0.1 * p.box : p.x + 0.1 * p.box; // the oracle loses digits near the rod
        const auto turned = [&](double h) {
            BoxPoint q = p;
            q.heading += h;
            return periodic_field(q);
        };
        const PeriodicField field = field_of(p);
        const double r = std::hypot(p.x, p.y), angle = angle_of_change(p);
        const Norms of_heading =
            largest_on_circle(r, [&](double x, double y) { return norms(field.by_heading(x, y, plain)); });
        // of the differences: rounding over a 100th of the angle
        const Norms scale = sum(of_heading, largest_at(field, r), 1e-2 / angle);
        const FieldValues got = field.by_heading(p.x, p.y, plain);
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        CHECK(worst(distances(got, field_difference(turned, 0.01 * angle)), scale) < 1e-9); // periodic.hpp
    }
}

TEST_CASE("what a rectangle's images do to their own rod changes with its heading as by differences") {
    for (const double aspect : {0.25, 0.7, 3.0})
        for (const double ratio : {1e-2, 0.5, 5.0, 12.1, 100.0})
            for (const double heading : headings) {
                const BoxPoint p{0.1, 0.0, 1.0 / ratio, 1.3, 1.0, heading, aspect};
                const auto turned = [&](double h) {
                    BoxPoint q = p;
                    q.heading += h;
                    return field_of(q).at_own_place(plain);
                };
                const double angle = std::min(1.0, 2.0 * pi / (ratio * std::max(1.0, aspect)));
                const FieldValues got = field_of(p).own_place_by_heading(plain);
                CAPTURE(aspect, ratio, heading);
                // By symmetry it may vanish: of the field, and 2e-11 of U over a length, 100 ulp (G_T - G_L
                // at c L = 0.01) over a 100th of the angle
                const Norms images = norms(field_of(p).at_own_place(plain));
                Norms scale = sum(norms(got), images, 0.1 / angle);
                for (double& one : scale)
                    one += 2e-2 * images[0] / angle;
                CHECK(worst(distances(got, field_difference(turned, 0.01 * angle)), scale) < 1e-9);
            }
}

TEST_CASE("a rectangle's field changes with the medium as by differences") {
    RandomStream random(124);
    for (int k = 0; k < 42; ++k) {
        BoxPoint p = sample(random, k + 1, 200.0);
        p.xi = std::min(p.xi, 50.0 * p.box);
        p.eta = std::max(0.1, p.eta);
        const PeriodicField field = field_of(p);
        const elastic::MediumDerivatives d = field.medium_derivatives(p.x, p.y, plain);
        const Norms whole = norms(field.at(p.x, p.y, plain));
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        for (const auto& [parameter, got] :
             {std::pair{&BoxPoint::eta, d.by_eta}, std::pair{&BoxPoint::xi, d.by_xi}}) {
            const auto changed = [&](double h) {
                BoxPoint q = p;
                q.*parameter += h;
                return field_of(q).at(q.x, q.y, plain);
            };
            const FieldValues exact = field_difference(changed, 0.02 * (p.*parameter));
            // 1e-6: of the differences, as for the square
            CHECK(worst(distances(got, exact), sum(norms(exact), whole, 0.01 / (p.*parameter))) < 1e-6);
        }
    }
}

TEST_CASE("two rods half a rectangle apart make the field of the half rectangle") {
    RandomStream random(125);
    for (int k = 0; k < 70; ++k) {
        BoxPoint half = sample(random, k, 1e3);
        half.aspect = k % 2 ? 1.0 : half.aspect / 2.0; // of a square, too
        BoxPoint whole = half;
        whole.aspect *= 2.0;
        const Vector shift = to_rod(half.heading, 0.0, half.sides().y);
        const PeriodicField field = field_of(whole);
        const FieldValues one = field.at(half.x, half.y, plain),
                          other = field.at(half.x - shift.x, half.y - shift.y, plain),
                          wanted = field_of(half).at(half.x, half.y, plain);
        FieldValues both = one;
        elastic::add_times(both, 1.0, other);
        const Norms scale = sum(norms(one), norms(other), 1.0);
        CAPTURE(k, half.aspect, half.box / half.xi, half.eta, half.heading, half.x / half.box);
        CHECK(worst(distances(both, wanted), scale) < promised);
        CHECK(worst(distances(one, wanted), scale) > 1e-6);
    }
}

TEST_CASE("a rectangle and its rod turned by a quarter are the rectangle with its sides exchanged") {
    RandomStream random(126);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, k, 100.0);
        const PeriodicField field = field_of(p), turned({.eta = p.eta, .xi = p.xi},
                                                        {p.sides().y, p.sides().x}, p.heading + pi / 2);
        const Norms scale = largest_at(field, std::hypot(p.x, p.y));
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading);
        CHECK(worst(distances(turned.at(p.x, p.y, plain), field.at(p.x, p.y, plain)), scale) < 1e-11);
        const PeriodicField same_box({.eta = p.eta, .xi = p.xi}, p.sides(), p.heading + pi / 2);
        if (std::abs(std::log(p.aspect)) > 0.1)
            CHECK(worst(distances(same_box.at(p.x, p.y, plain), field.at(p.x, p.y, plain)), scale) > 1e-9);
    }
}

TEST_CASE("the field of a rectangle repeats, by each side its own") {
    RandomStream random(127);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, k, 1e3);
        const PeriodicField field = field_of(p);
        const Vector shift = to_rod(p.heading, 2.0 * p.sides().x, -3.0 * p.sides().y);
        const Norms scale = largest_at(field, std::hypot(p.x, p.y));
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading);
        CHECK(worst(distances(field.at(p.x + shift.x, p.y + shift.y, plain), field.at(p.x, p.y, plain)),
                    scale) < 1e-10); // rounding of the place over its distance from the rod
    }
}
