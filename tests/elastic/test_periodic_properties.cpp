// What a field of a periodic box must do whatever its formula.

#include "periodic_cases.hpp"

#include "elastic/field_algebra.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldValues;
using elastic::PeriodicField;
using elastic::Vector;

namespace {

PeriodicField box_of(double ratio, double eta, double heading, const PeriodicBox& box = 1.0) {
    return {{.eta = eta, .xi = box.shorter() / ratio}, box, heading};
}

/// |-(1/xi) d_x U - lap U - eta grad div U + xhat/Lx Ly| over the sum of its parts.
double residual(const PeriodicField& field, double x, double y, double counterforce) {
    const double xi = field.medium().xi, eta = field.medium().eta;
    const FieldValues f = field.at(x, y, plain);
    const double length = std::min(std::hypot(x, y), std::min(xi / std::max(1.0, field.medium().nu()), 0.1));
    const auto uy = [&](double h) { return field.at(x + h, y, plain).displacement.y; };
    const double uy_x = difference_quotient(uy, length / 64.0);
    const double part[] = {f.strain.xx / xi, f.laplacian.x, eta * f.gradient_of_trace.x, -counterforce,
                           uy_x / xi,        f.laplacian.y, eta * f.gradient_of_trace.y};
    double scale = 0.0;
    for (const double p : part)
        scale += std::abs(p);
    return std::hypot(part[0] + part[1] + part[2] + part[3], part[4] + part[5] + part[6]) / scale;
}

} // namespace

TEST_CASE("the periodic field solves the equation with the force taken off evenly") {
    RandomStream random(81);
    for (int k = 0; k < 240; ++k) {
        const bool square = k % 2 == 0;
        const PeriodicBox box{1.0, square ? 1.0 : random.log_uniform(1.0, 4.0)};
        const double ratio = random.log_uniform(1e-2, 1e2), eta = random.log_uniform(1e-2, 1e2);
        const PeriodicField field =
            box_of(ratio, eta, headings[k % 7], k % 4 < 2 ? box : PeriodicBox(box.y, box.x));
        const double r = random.uniform(0.05, square ? 0.5 : 2.0), angle = random.uniform(-pi, pi);
        CAPTURE(ratio, eta, box.y, r, angle);
        // 1e-9: the difference quotient of field values of 1e-13 over steps of 1/64
        CHECK(residual(field, r * std::cos(angle), r * std::sin(angle), 1.0 / box.area()) < 1e-9);
    }
    CHECK(residual(box_of(1.0, 1.0, 0.3), 0.3, 0.2, 0.0) > 1e-3); // without the counterforce
}

TEST_CASE("the periodic field and its gradients repeat, by each side its own") {
    RandomStream random(82);
    for (int k = 0; k < 140; ++k) {
        const BoxPoint p = sample(random, k, 1e3);
        const PeriodicField field = field_of(p);
        const Vector shift = to_rod(p.heading, 2.0 * p.sides().x, -3.0 * p.sides().y);
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        // 1e-10: rounding of the place, 3 of 16 digits times the box over the distance from the rod
        const double r = std::hypot(p.x, p.y);
        CHECK(worst(distances(field.at(p.x + shift.x, p.y + shift.y, plain), field.at(p.x, p.y, plain)),
                    largest_at(field, r)) < 1e-10);
        const FieldValues here = field.at(p.x, p.y, with_gradients),
                          there = field.at(p.x + shift.x, p.y + shift.y, with_gradients);
        const Norms scale = largest_on_circle(r, [&](double x, double y) {
            const FieldValues f = field.at(x, y, with_gradients);
            return sum(norms(by_place(f, true)), norms(by_place(f, false)));
        });
        for (const bool by_x : {true, false})
            for (const std::size_t q : {1, 2, 3})
                CHECK(distances(by_place(there, by_x), by_place(here, by_x))[q] < 1e-10 * scale[q]);
    }
}

TEST_CASE("the periodic field has no jump where its sums change") {
    for (const double aspect : {1.0, 0.25, 0.6, 4.0})
        for (const double ratio : {1e-3, 4e-3, 6e-3, 0.019, 0.021, 1.0, 8.0, 11.9, 12.1, 30.0, 100.0, 1000.0})
            for (const double heading : headings) {
                if (ratio > 100.0 && aspect != 1.0)
                    continue; // beyond the range of rectangles
                const double step = 1e-12, x_edge = 0.5 * std::max(1.0, 1.0 / aspect),
                             y_edge = 0.5 * std::max(1.0, aspect);
                const PeriodicField field = box_of(ratio, 3.0, heading, {2.0 * x_edge, 2.0 * y_edge});
                for (int k = 0; k < 50; ++k) { // the near square's edges, the diagonal beyond it, both seams
                    const double t = 0.044 * (k % 10) - 0.2;
                    const Vector at = k < 10   ? Vector{0.22, t}
                                      : k < 20 ? Vector{0.3 + 0.4 * t, -0.3 - 0.4 * t}
                                      : k < 30 ? Vector{x_edge, t}
                                      : k < 40 ? Vector{t, y_edge}
                                               : Vector{t, -0.22};
                    const Vector here = to_rod(heading, at.x - step, at.y - step),
                                 there = to_rod(heading, at.x + step, at.y + step);
                    CAPTURE(aspect, ratio, heading, at.x, at.y);
                    // 1e-10 is promised; the place moves by 3e-12, and the wake is 1/sqrt(ratio) wide
                    CHECK(worst(distances(field.at(there.x, there.y, plain), field.at(here.x, here.y, plain)),
                                largest_at(field, std::hypot(at.x, at.y))) <
                          1e-10 + 2e-11 * std::sqrt(ratio));
                }
            }
}

TEST_CASE("the mean of the periodic displacement is zero") {
    for (const double aspect : {1.0, 2.5, 0.4})
        for (const double ratio : {0.1, 5.0, 40.0})
            for (const double heading : {0.0, 0.7}) {
                // The row at y offsets of 1/2 from the rod holds no singularity, and the mean over a row
                // obeys g'' + ... = const: sum midpoints of the box, the singular ln r summed by its grid's
                // own mean.
                const PeriodicBox box{std::max(1.0, 1.0 / aspect), std::max(1.0, aspect)};
                const PeriodicField field = box_of(ratio, 1.3, heading, box);
                const auto mean = [&](int n) {
                    const int nx = static_cast<int>(std::lround(n * box.x)),
                              ny = static_cast<int>(std::lround(n * box.y));
                    Vector sum;
                    for (int i = 0; i < nx; ++i)
                        for (int j = 0; j < ny; ++j) {
                            const Vector at = to_rod(heading, box.x * ((i + 0.5) / nx - 0.5),
                                                     box.y * ((j + 0.5) / ny - 0.5));
                            const auto u = field.at(at.x, at.y, {.displacement = true}).displacement;
                            sum.x += u.x / (nx * ny);
                            sum.y += u.y / (nx * ny);
                        }
                    return sum;
                };
                // The midpoint rule errs as h^2 by the logarithm alone: two grids take that off, h^3 is left.
                const Vector coarse = mean(30), fine = mean(60);
                CAPTURE(aspect, ratio, heading);
                CHECK(std::abs((4.0 * fine.x - coarse.x) / 3.0) < 2e-5);
                CHECK(std::abs((4.0 * fine.y - coarse.y) / 3.0) < 2e-5);
            }
}

TEST_CASE("a box of many screening lengths is the infinite plane beside and ahead of the rod") {
    const elastic::Medium medium{.eta = 1.0, .xi = 1.0};
    const PeriodicField field(medium, 400.0, 0.3);
    const elastic::Field plane(medium);
    const double x = 0.5, y = 1.0;
    const FieldValues got = field.at(x, y, plain), wanted = plane.at(x, y, plain);
    // The images' wakes are left: U of the next one at the distance L sin(0.3) beside its axis, below
    // sqrt(xi/L)/2 pi = 8e-3, and its slope below that over the wake's width 2 sqrt(xi L) = 40
    CHECK(distances(got, wanted)[0] < 8e-3);
    CHECK(distances(got, wanted)[1] < 2e-4);
    CHECK(distances(got, wanted)[2] < 1e-4);
    CHECK(norms(wanted)[1] > 1e-2);
    const FieldValues slopes = field.at(x, y, with_gradients), exact = plane.at(x, y, with_gradients);
    CHECK(distances(by_place(slopes, false), by_place(exact, false))[1] < 1e-5);
    CHECK(distances(by_place(slopes, true), by_place(exact, true))[2] < 1e-5);
    CHECK(norms(by_place(exact, false))[1] > 1e-2);
    const Norms turned = norms(field.heading_derivative(x, y, plain)); // the images' wakes move by L a radian
    CHECK(turned[0] < 8e-3 * 400.0 / 40.0);
    CHECK(turned[1] < 2e-4 * 400.0 / 40.0);
    CHECK(turned[2] < 1e-4 * 400.0 / 40.0);
}

TEST_CASE("two rods half a rectangle apart make the field of the half rectangle") {
    RandomStream random(125);
    for (int k = 0; k < 70; ++k) {
        BoxPoint half = sample(random, 2 * k + 1, 1e3);
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
        const Norms scale = sum(norms(one), norms(other));
        CAPTURE(k, half.aspect, half.box / half.xi, half.eta, half.heading, half.x / half.box);
        CHECK(worst(distances(both, wanted), scale) < 1e-10);
        CHECK(worst(distances(one, wanted), scale) > 1e-6);
    }
}

TEST_CASE("a rectangle and its rod turned by a quarter are the rectangle with its sides exchanged") {
    RandomStream random(126);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, 2 * k + 1, 100.0);
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

TEST_CASE("the periodic field has the box's symmetries") {
    for (const double ratio : {0.01, 2.0, 11.0, 60.0}) {
        const PeriodicField along = box_of(ratio, 2.0, 0.0), across = box_of(ratio, 2.0, pi / 2),
                            turned = box_of(ratio, 2.0, 0.4), mirrored = box_of(ratio, 2.0, -0.4);
        for (const auto& [x, y] : {std::pair{0.1, 0.15}, {-0.3, 0.1}, {0.05, -0.4}}) {
            const FieldValues f = along.at(x, y, plain), g = turned.at(x, y, plain);
            const Norms scale = norms(f);
            CHECK(worst(distances(across.at(x, y, plain), f), scale) < 1e-11); // a square's quarter turn
            CHECK(worst(distances(box_of(ratio, 2.0, -3 * pi).at(-x, -y, plain),
                                  box_of(ratio, 2.0, pi).at(-x, -y, plain)),
                        scale) < 1e-10); // headings differ by rounding times L/xi
            FieldValues m = mirrored.at(x, -y, plain);
            m.displacement.y *= -1.0;
            m.strain.xy *= -1.0;
            m.laplacian.y *= -1.0;
            m.gradient_of_trace.y *= -1.0;
            m.dipole.y *= -1.0;
            FieldValues same = g;
            CHECK(distances(m, same)[0] < 1e-11 * norms(g)[0]);
            CHECK(distances(m, same)[1] < 1e-11 * norms(g)[1]);
            CHECK(distances(m, same)[2] < 1e-11 * norms(g)[2]);
        }
    }
}

TEST_CASE("near the rod the periodic field is the infinite plane's and the images'") {
    for (const double ratio : {0.015, 3.0, 50.0}) {
        const PeriodicField field = box_of(ratio, 1.0, 0.5);
        const elastic::Field plane(field.medium());
        const FieldValues own = field.self_image_field(plain);
        const double r = 1e-9;
        const FieldValues got = field.at(r, r, plain), single = plane.at(r, r, plain);
        CHECK(std::abs(got.displacement.x - single.displacement.x - own.displacement.x) < 1e-8);
        CHECK(worst(distances(got, single), norms(single)) < 1.0);
        CHECK(distances(got, single)[1] < 1e-9 * norms(single)[1] + 2.0 * norms(own)[1]);
        CHECK(norms(own)[1] > 0.0);
    }
    for (const double ratio : {0.015, 3.0, 50.0}) { // the mean of the rest over a small circle
        const PeriodicField field = box_of(ratio, 1.0, 0.5);
        const elastic::Field plane(field.medium());
        elastic::SymmetricTensor mean;
        for (int k = 0; k < 8; ++k) {
            const double r = 1e-3, x = r * std::cos(k * pi / 4), y = r * std::sin(k * pi / 4);
            const auto with = field.at(x, y, plain).strain, without = plane.at(x, y, plain).strain;
            mean.xx += (with.xx - without.xx) / 8;
            mean.xy += (with.xy - without.xy) / 8;
        }
        const FieldValues own = field.self_image_field(plain);
        CHECK(std::abs(mean.xy - own.strain.xy) <
              1e-4 * norms(own)[1]); // r^2 times the square of c L = 25 and less
        CHECK(std::abs(mean.xx - own.strain.xx) < 1e-3 * norms(own)[1]);
    }
    CHECK(box_of(3.0, 1.0, 0.0).self_image_field(plain).strain.xy ==
          Approx(0.0).margin(1e-13)); // mirror symmetry
    CHECK(std::abs(box_of(3.0, 1.0, 0.5).self_image_field(plain).strain.xy) > 1e-6);
}

TEST_CASE("bad boxes and places are errors") {
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    for (const double box : {0.0, -1.0, nan, infinite})
        CHECK_THROWS_WITH(PeriodicField({}, box), Catch::Contains("box ="));
    for (const PeriodicBox& box :
         {PeriodicBox{2.0, -1.0}, {0.0, 1.0}, {nan, 1.0}, {1.0, nan}, {infinite, 1.0}})
        CHECK_THROWS_WITH(PeriodicField({}, box), Catch::Contains("> 0 and finite"));
    CHECK_THROWS_WITH(PeriodicField({}, {2.0, -1.0}), Catch::Contains("box = 2 x -1"));
    CHECK_THROWS_WITH(PeriodicField({}, {1.0, 1001.0}), Catch::Contains("1000 times"));
    CHECK_THROWS_AS(PeriodicField({}, 1e8), InputError);
    CHECK_THROWS_WITH(PeriodicField({}, {1e5, 3e6}), Catch::Contains("infinite plane"));
    CHECK_THROWS_WITH(PeriodicField({.eta = 1.0, .xi = 1e30}, 1e-300), Catch::Contains("units"));
    const PeriodicField tiny({.eta = 1e12, .xi = 1e30}, 1e-60);
    CHECK(std::isfinite(worst(distances(tiny.at(1e-61, 2e-61, plain), {}), largest_at(tiny, 2e-61))));
    for (const double heading : {nan, infinite})
        CHECK_THROWS_WITH(PeriodicField({}, 1.0, heading), Catch::Contains("heading ="));
    CHECK_THROWS_AS(PeriodicField({.eta = -2.0, .xi = 1.0}, 1.0), InputError);
    const PeriodicField field({}, 2.0);
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {-4.0, 6.0}, {nan, 0.0}, {0.1, infinite}}) {
        CHECK_THROWS_AS(field.at(x, y, {.displacement = true}), InputError);
        CHECK_THROWS_AS(field.medium_derivatives(x, y, {.displacement = true}), InputError);
    }
    CHECK_THROWS_WITH(field.at(2.0, -4.0, {.displacement = true}),
                      Catch::Contains("x = 2, y = -4") && Catch::Contains("images"));
    CHECK_THROWS_WITH(field.at(nan, 0.0, {.displacement = true}), Catch::Contains("finite"));
    CHECK_THROWS_WITH(field.heading_derivative(0.1, 0.1, {.gradients = true}), Catch::Contains("gradients"));
    CHECK_THROWS_WITH(field.own_place_by_heading({.gradients = true}), Catch::Contains("gradients"));
    CHECK_THROWS_WITH(field.medium_derivatives(0.1, 0.1, {.gradients = true}), Catch::Contains("gradients"));
}

TEST_CASE("far outside the stated range of boxes the field is still right") {
    for (const double ratio : {1e-12, 1e-6, 1e5}) {
        const BoxPoint p{0.1, 0.23, 1.0 / ratio, 1.3, 1.0, 0.3};
        const PeriodicField field = box_of(ratio, 1.3, 0.3);
        const FieldValues f = field.at(p.x, p.y, plain);
        if (ratio < 1.0) { // the oracle subtracts and loses xi/L of 19 digits: compare with a nearby medium
            const FieldValues limit = box_of(1e-4, 1.3, 0.3).at(p.x, p.y, plain);
            CHECK(worst(distances(f, limit), largest_at(field, 0.25)) < 1e-3); // U changes by L/xi ln(L/xi)
        }
        CHECK(residual(field, p.x, p.y, 1.0) < 1e-7);
    }
}
