// Gradients of the field of a periodic box.

#include "periodic_cases.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::oracle;
using elastic::FieldValues;
using elastic::PeriodicField;
using elastic::Vector;

namespace {

constexpr double promised = 1e-9; // periodic.hpp

/// The worst of both directions against the largest gradients at that distance.
double error_of(const PeriodicField& field, double x, double y, const FieldValues& exact) {
    const FieldValues got = field.at(x, y, with_gradients);
    const Norms scale = largest_on_circle(std::hypot(x, y), [&](double u, double v) {
        const FieldValues f = field.at(u, v, with_gradients);
        Norms n = norms(by_place(f, true));
        const Norms m = norms(by_place(f, false));
        for (std::size_t q = 0; q < n.size(); ++q)
            n[q] = std::max(n[q], m[q]);
        return n;
    });
    double largest = 0.0;
    for (const bool by_x : {true, false}) {
        const Norms d = distances(by_place(got, by_x), by_place(exact, by_x));
        for (const std::size_t q : {1, 2, 3})
            largest = std::max(largest, d[q] / scale[q]);
    }
    return largest;
}

} // namespace

TEST_CASE("gradients of the periodic field agree with Ewald's sums") {
    RandomStream random(101);
    for (int k = 0; k < 210; ++k) {
        const BoxPoint p = sample(random, k, k % 2 ? 60.0 : 100.0);
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        const FieldValues exact = periodic_field(p);
        CHECK(error_of(field_of(p), p.x, p.y, exact) < promised);
        FieldValues wrong = exact;
        wrong.strain_y.xx *= 1.0 + 1e-4;
        wrong.strain_y.xy += 1e-7 * norms(by_place(exact, true))[1];
        CHECK(error_of(field_of(p), p.x, p.y, wrong) > 1e-10);
    }
}

TEST_CASE("gradients of the periodic field are those of its own differences, up to 1000 screening lengths") {
    RandomStream random(102);
    for (int k = 0; k < 70; ++k) {
        const BoxPoint p = sample(random, 2 * k, 1e3); // squares: their images are 0.3 away and more
        const PeriodicField field = field_of(p);
        const double r = std::hypot(p.x, p.y);
        const double fastest = 0.5 / p.xi * std::max(1.0, field.medium().nu());
        const double step = 0.02 * std::min({r, 0.3 * p.sides().shorter(), 1.0 / fastest});
        const auto slope = [&](auto part, double u, double v) {
            return difference_quotient(
                [&](double h) { return part(field.at(p.x + u * h, p.y + v * h, plain)); }, step);
        };
        const auto xy = [](const FieldValues& f) { return f.strain.xy; };
        const auto trace_y = [](const FieldValues& f) { return f.gradient_of_trace.y; };
        const FieldValues f = field.at(p.x, p.y, with_gradients);
        const Norms n = norms(by_place(f, true)), m = norms(by_place(f, false)), whole = largest_at(field, r);
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
        const BoxPoint p = sample(random, 2 * k, 1e3);
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

// --- Derivative of the periodic field by the rod's heading

namespace {

/// By differences over a 100th of the angle of change, which errs by 9! 0.01^8/630 = 6e-14 if f^(n) grows as
/// n!, and by the rounding of the field over that angle.
template<class FieldAt>
FieldValues by_differences(FieldAt field_at, const BoxPoint& p) {
    const auto turned = [&](double h) {
        BoxPoint q = p;
        q.heading += h;
        return field_at(q);
    };
    return field_difference(turned, 0.01 * angle_of_change(p));
}

/// Of the derivative, and of that rounding.
Norms scale_of(const PeriodicField& field, const BoxPoint& p) {
    const double r = std::hypot(p.x, p.y);
    const Norms heading_derivative = largest_on_circle(
        r, [&](double x, double y) { return norms(field.heading_derivative(x, y, plain)); });
    return sum(heading_derivative, largest_at(field, r), 1e-2 / angle_of_change(p));
}

} // namespace

TEST_CASE("the derivative of the periodic field by heading is that of differences of Ewald's sums") {
    RandomStream random(111);
    for (int k = 0; k < 56; ++k) {
        BoxPoint p = sample(random, k, k % 2 ? 60.0 : 100.0);
        p.x = p.x < 0.0 ? p.x - 0.1 * p.box : p.x + 0.1 * p.box; // the oracle loses digits near the rod
        p.xi = std::min(p.xi, 100.0 * p.box);                    // and in small boxes
        const PeriodicField field = field_of(p);
        const FieldValues got = field.heading_derivative(p.x, p.y, plain),
                          exact = by_differences(periodic_field, p);
        CAPTURE(k, p.aspect, p.box / p.xi, p.eta, p.heading, p.x / p.box, p.y / p.box);
        const Norms scale = scale_of(field, p);
        CHECK(worst(distances(got, exact), scale) < promised);
        FieldValues wrong = got;
        wrong.dipole.x += 1e-8 * scale[4];
        CHECK(worst(distances(wrong, exact), scale) > promised);
    }
}

TEST_CASE("the derivative of the periodic field by heading is that of its own differences, anywhere") {
    RandomStream random(112);
    for (int k = 0; k < 210; ++k) { // up to two cells away from the rod
        const double reach = k % 2 ? 0.5 : 4.0, xi = 2.0 / random.log_uniform(1e-3, 1e3);
        const BoxPoint p{random.uniform(-reach, reach),
                         random.uniform(-reach, reach),
                         xi,
                         random.log_uniform(1e-2, 1e2),
                         2.0,
                         headings[k % 7]};
        const auto field_at = [](const BoxPoint& q) { return field_of(q).at(q.x, q.y, plain); };
        const PeriodicField field = field_of(p);
        CAPTURE(k, xi, p.eta, p.heading, p.x, p.y);
        CHECK(worst(distances(field.heading_derivative(p.x, p.y, plain), by_differences(field_at, p)),
                    scale_of(field, p)) < promised);
    }
}

TEST_CASE("what the images do to their own rod changes with its heading as by differences") {
    for (const double aspect : {1.0, 0.25, 0.7, 3.0})
        for (const double ratio : {1e-3, 1e-2, 0.019, 0.5, 5.0, 11.9, 12.1, 100.0})
            for (const double heading : headings) {
                const BoxPoint p{0.01, 0.0, 1.0 / ratio, 1.3, 1.0, heading, aspect};
                const auto own_field = [](const BoxPoint& q) { return field_of(q).self_image_field(plain); };
                const FieldValues got = field_of(p).own_place_by_heading(plain);
                CAPTURE(aspect, ratio, heading);
                // By symmetry it may vanish: of the field, and 2e-11 of U over a length, 100 ulp (G_T - G_L
                // at c L = 0.01), over a 100th of the angle
                const Norms own = norms(field_of(p).self_image_field(plain));
                Norms scale = sum(norms(got), own, 0.1 / angle_of_change(p));
                for (double& one : scale)
                    one += 2e-2 * own[0] / angle_of_change(p);
                CHECK(worst(distances(got, by_differences(own_field, p)), scale) < promised);
            }
}

TEST_CASE("the derivative by heading has the box's symmetries") {
    for (const double ratio : {0.01, 2.0, 11.0, 60.0}) {
        const auto box_of = [&](double heading) {
            return PeriodicField({.eta = 2.0, .xi = 1.0 / ratio}, 1.0, heading);
        };
        const FieldValues on_axis = box_of(0.0).heading_derivative(0.3, 0.0, plain),
                          size = box_of(0.4).heading_derivative(0.3, 0.0, plain);
        CHECK(std::abs(on_axis.displacement.x) < 1e-11 * norms(size)[0]); // mirror symmetry
        CHECK(std::abs(on_axis.strain.yy) < 1e-11 * norms(size)[1]);
        CHECK(norms(on_axis)[1] > 1e-3 * norms(size)[1]);
        for (const auto& [x, y] : {std::pair{0.1, 0.15}, {-0.3, 0.1}, {0.05, -0.4}}) {
            const FieldValues f = box_of(0.4).heading_derivative(x, y, plain);
            // a quarter turn; the headings differ by rounding times L/xi
            CHECK(worst(distances(box_of(0.4 + pi / 2).heading_derivative(x, y, plain), f), norms(f)) <
                  1e-10);
        }
    }
}

TEST_CASE("the derivative by heading repeats but for the images' own motion") {
    for (const double ratio : {0.01, 2.0, 30.0})
        for (const auto& [x, y] : {std::pair{0.1, 0.15}, {-0.3, 0.4}}) {
            const PeriodicField field({.eta = 2.0, .xi = 1.0 / ratio}, 1.0, 0.4);
            const Vector shift = to_rod(0.4, 2.0, -1.0);
            const FieldValues here = field.heading_derivative(x, y, plain),
                              there = field.heading_derivative(x + shift.x, y + shift.y, plain),
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

// --- Derivatives of the periodic field by eta and xi

TEST_CASE("derivatives of the periodic field by the medium are those of differences") {
    RandomStream random(91);
    for (int k = 0; k < 112; ++k) {
        BoxPoint p = sample(random, k, 200.0);
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
            // The field itself over the parameter counts as much as its derivative: a fit's relative steps
            // see no less. 1e-6 is that of the differences.
            const Norms scale = sum(norms(exact), whole, 0.01 / (p.*parameter));
            CHECK(worst(distances(got, exact), scale) < 1e-6);
            FieldValues wrong = got;
            wrong.strain.xx += 1e-4 * (scale[1] + whole[1] / (p.*parameter));
            CHECK(worst(distances(wrong, exact), scale) > 1e-6);
        }
    }
}

TEST_CASE("only what is asked of a periodic field and its derivatives is made") {
    const PeriodicField field({}, 2.0, 0.3);
    for (const double x : {0.2, 0.8, 2.1}) {
        const elastic::MediumDerivatives medium_derivatives = field.medium_derivatives(x, 0.1, plain),
                                         one = field.medium_derivatives(x, 0.1, {.displacement = true});
        CHECK(one.by_xi.displacement.x == medium_derivatives.by_xi.displacement.x);
        CHECK(one.by_eta.displacement.y == medium_derivatives.by_eta.displacement.y);
        CHECK(std::isnan(norms(one.by_xi)[1]));
        CHECK(std::isnan(norms(one.by_eta)[4]));
        CHECK(field.at(x, 0.1, {.displacement = true}).displacement.x ==
              field.at(x, 0.1, plain).displacement.x);
        const FieldValues turned = field.heading_derivative(x, 0.1, {.displacement = true});
        CHECK(turned.displacement.x == field.heading_derivative(x, 0.1, plain).displacement.x);
        CHECK(std::isnan(turned.strain.xx));
        CHECK(std::isnan(turned.dipole.y));
        CHECK(std::isnan(turned.strain_x.xx));
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
    CHECK(std::isfinite(field.self_image_field(with_gradients).strain_x.xy));
}
