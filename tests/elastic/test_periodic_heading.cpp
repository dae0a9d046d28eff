// Derivative of the periodic field by the rod's heading.

#include "periodic_cases.hpp"

#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldValues;
using elastic::PeriodicField;
using elastic::Vector;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double headings[] = {0.0, 0.3, pi / 4, 1.2, pi / 2, 3.0, -2.2};
constexpr double promised = 1e-9; // periodic.hpp

/// Over how large an angle the field changes: a wave of the box over 2 pi xi/L, an image by its distance.
double angle_of_change(const BoxPoint& p) {
    const Vector at = elastic::turned(Vector{p.x, p.y}, std::cos(p.heading), std::sin(p.heading));
    double nearest = 1e300;
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j)
            if (i != 0 || j != 0)
                nearest = std::min(nearest, std::hypot(at.x - i * p.box, at.y - j * p.box));
    const double fastest = std::max(1.0, 1.0 / (1.0 + p.eta));
    return std::min({1.0, 2.0 * pi * p.xi / p.box / fastest, nearest / std::hypot(p.x, p.y)});
}

/// By a 100th of that, which errs by 9! 0.01^8/630 = 6e-14 if f^(n) grows as n!.
template<class FieldAt>
FieldValues by_differences(FieldAt field_at, const BoxPoint& p) {
    return field_difference(field_at, 0.01 * angle_of_change(p));
}

Norms largest_by_heading(const PeriodicField& field, double r) {
    return largest_on_circle(r, [&](double x, double y) { return norms(field.by_heading(x, y, plain)); });
}

PeriodicField field_of(const BoxPoint& p) { return {{.eta = p.eta, .xi = p.xi}, p.box, p.heading}; }

} // namespace

TEST_CASE("the derivative of the periodic field by heading is that of differences of Ewald's sums") {
    RandomStream random(111);
    for (int k = 0; k < 28; ++k) {
        const double box = random.log_uniform(1e-2, 1e2), ratio = random.log_uniform(1e-2, 100.0);
        const double eta = k % 11 == 0 ? random.uniform(-0.5, 0.0) : random.log_uniform(1e-2, 1e2);
        const double r = random.uniform(0.15, 0.7),
                     angle = random.uniform(-pi, pi); // the oracle loses near it
        const BoxPoint p{
            r * box * std::cos(angle), r * box * std::sin(angle), box / ratio, eta, box, headings[k % 7]};
        const auto turned = [&](double h) {
            BoxPoint q = p;
            q.heading += h;
            return periodic_field(q);
        };
        const PeriodicField field = field_of(p);
        const FieldValues got = field.by_heading(p.x, p.y, plain), exact = by_differences(turned, p);
        CAPTURE(k, ratio, eta, p.heading, r, angle);
        const Norms scale = largest_by_heading(field, r * box);
        CHECK(worst(distances(got, exact), scale) < promised);
        FieldValues wrong = got;
        wrong.dipole.x += 1e-8 * scale[4];
        CHECK(worst(distances(wrong, exact), scale) > promised);
    }
}

TEST_CASE("the derivative of the periodic field by heading is that of its own differences, anywhere") {
    RandomStream random(112);
    for (int k = 0; k < 210; ++k) { // up to two cells away from the rod
        const double box = 2.0, ratio = random.log_uniform(1e-3, 1e3), eta = random.log_uniform(1e-2, 1e2);
        const double reach = k % 2 ? 0.5 : 4.0;
        const BoxPoint p{random.uniform(-reach, reach),
                         random.uniform(-reach, reach),
                         box / ratio,
                         eta,
                         box,
                         headings[k % 7]};
        const auto turned = [&](double h) {
            BoxPoint q = p;
            q.heading += h;
            return field_of(q).at(p.x, p.y, plain);
        };
        const PeriodicField field = field_of(p);
        const FieldValues got = field.by_heading(p.x, p.y, plain), exact = by_differences(turned, p);
        CAPTURE(k, ratio, eta, p.heading, p.x, p.y);
        // of the differences: rounding of the field over a 100th of the angle, and of the place by cells
        const double r = std::hypot(p.x, p.y);
        const Norms field_scale = largest_at(field, r);
        Norms scale = largest_by_heading(field, r);
        for (std::size_t q = 0; q < scale.size(); ++q)
            scale[q] += 1e-2 * field_scale[q] / angle_of_change(p);
        CHECK(worst(distances(got, exact), scale) < promised);
    }
}

TEST_CASE("what the images do to their own rod changes with its heading as by differences") {
    for (const double ratio : {1e-3, 0.019, 0.5, 5.0, 11.9, 12.1, 100.0})
        for (const double heading : headings) {
            const BoxPoint p{0.1, 0.0, 1.0 / ratio, 1.3, 1.0, heading};
            const auto turned = [&](double h) {
                BoxPoint q = p;
                q.heading += h;
                return field_of(q).at_own_place(plain);
            };
            const FieldValues got = field_of(p).own_place_by_heading(plain),
                              exact = by_differences(turned, p);
            CAPTURE(ratio, heading);
            // By symmetry it nearly vanishes at small c L, or altogether: 1e-10 of the field, 1e-12 of U/L
            // too, of which the differences have 1e-15 over a 100th of the angle
            Norms scale = norms(got);
            const Norms own = norms(field_of(p).at_own_place(plain));
            for (std::size_t q = 0; q < scale.size(); ++q)
                scale[q] += (0.1 * own[q] + 1e-3 * own[0]) / angle_of_change(p);
            CHECK(worst(distances(got, exact), scale) < promised);
        }
}

TEST_CASE("the derivative by heading has the box's symmetries") {
    for (const double ratio : {0.01, 2.0, 11.0, 60.0}) {
        const auto box_of = [&](double heading) {
            return PeriodicField({.eta = 2.0, .xi = 1.0 / ratio}, 1.0, heading);
        };
        const FieldValues on_axis = box_of(0.0).by_heading(0.3, 0.0, plain),
                          size = box_of(0.4).by_heading(0.3, 0.0, plain);
        CHECK(std::abs(on_axis.displacement.x) < 1e-11 * norms(size)[0]); // mirror symmetry
        CHECK(std::abs(on_axis.strain.yy) < 1e-11 * norms(size)[1]);
        CHECK(norms(on_axis)[1] > 1e-3 * norms(size)[1]);
        for (const auto& [x, y] : {std::pair{0.1, 0.15}, {-0.3, 0.1}, {0.05, -0.4}}) {
            const FieldValues f = box_of(0.4).by_heading(x, y, plain);
            // a quarter turn; the headings differ by rounding times L/xi
            CHECK(worst(distances(box_of(0.4 + pi / 2).by_heading(x, y, plain), f), norms(f)) < 1e-10);
        }
    }
}

TEST_CASE("the derivative by heading repeats but for the images' own motion") {
    for (const double ratio : {0.01, 2.0, 30.0})
        for (const auto& [x, y] : {std::pair{0.1, 0.15}, {-0.3, 0.4}}) {
            const PeriodicField field({.eta = 2.0, .xi = 1.0 / ratio}, 1.0, 0.4);
            const Vector shift = to_rod(0.4, 2.0, -1.0);
            const FieldValues here = field.by_heading(x, y, plain),
                              there = field.by_heading(x + shift.x, y + shift.y, plain),
                              f = field.at(x, y, {.strain = true, .polar = true, .gradients = true});
            // f(x + s) = f(x) with s turning as (s_y, -s_x)
            const double by_shift = shift.y * f.strain_x.yy - shift.x * f.strain_y.yy;
            CHECK(there.strain.yy ==
                  Approx(here.strain.yy - by_shift).epsilon(0).margin(1e-10 * norms(there)[1]));
            const double lap = shift.y * f.laplacian_x.y - shift.x * f.laplacian_y.y;
            CHECK(there.laplacian.y ==
                  Approx(here.laplacian.y - lap).epsilon(0).margin(1e-10 * norms(there)[2]));
            CHECK(std::abs(by_shift) > 1e-3 * norms(there)[1]);
        }
}

TEST_CASE("a rod in a large box hardly notices turning") {
    const elastic::Medium medium{.eta = 1.0, .xi = 1.0};
    const PeriodicField field(medium, 400.0, 0.3);
    const double x = 0.5, y = 1.0;
    const FieldValues f = field.at(x, y, plain), turned = field.by_heading(x, y, plain);
    // The images' wakes, sqrt(xi/L)/2 pi of U and 40 xi wide, move by L a radian
    CHECK(norms(turned)[0] < 8e-3 * 400.0 / 40.0);
    CHECK(norms(turned)[1] < 2e-4 * 400.0 / 40.0);
    CHECK(norms(turned)[2] < 1e-4 * 400.0 / 40.0);
    CHECK(norms(f)[1] > 1e-2);
}

TEST_CASE("only the wanted derivatives by heading are made") {
    const PeriodicField field({}, 2.0, 0.3);
    for (const double x : {0.2, 0.8, 2.1}) {
        const FieldValues all = field.by_heading(x, 0.1, plain),
                          one = field.by_heading(x, 0.1, {.displacement = true});
        CHECK(one.displacement.x == all.displacement.x);
        CHECK(std::isnan(one.strain.xx));
        CHECK(std::isnan(one.dipole.y));
        CHECK(std::isnan(one.strain_x.xx));
    }
}
