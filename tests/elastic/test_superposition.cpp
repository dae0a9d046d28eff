// Rods anywhere in the plane: the rod-frame field turned, and summed.

#include "error_norm.hpp"
#include "sample.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/field.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;
using namespace rodwake::oracle;
using oracle::Quantity;
using oracle::Real;

namespace {

constexpr FieldRequest plain{.displacement = true, .strain = true, .polar = true, .dipole = true};

/// S v or S t S^T written out as matrix products, in the order of oracle::components.
std::vector<Real> turned_exactly(const std::vector<Real>& v, double heading) {
    const Real c = cos(Real(heading)), s = sin(Real(heading)), S[2][2] = {{c, -s}, {s, c}};
    std::vector<Real> out(v.size(), Real(0));
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 2; ++k) {
            if (v.size() == 2)
                out[i] += S[i][k] * v[k];
            else
                for (std::size_t j = 0; j < 2; ++j)
                    for (std::size_t l = 0; l < 2; ++l)
                        out[2 * i + j] += S[i][k] * S[j][l] * v[2 * k + l];
        }
    return out;
}

} // namespace

TEST_CASE("a turned rod's field is the oracle's, turned") {
    RandomStream random(91);
    for (int k = 0; k < 60; ++k) {
        const Medium medium{.eta = random.log_uniform(0.1, 10.0), .xi = 1.0};
        const Source source{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-7.0, 7.0)};
        const double x = random.uniform(-2.0, 2.0), y = random.uniform(-2.0, 2.0);
        const double c = std::cos(source.heading), s = std::sin(source.heading);
        const FieldValues lab = lab_field(elastic::Field(medium), source, source.x + c * x - s * y,
                                          source.y + s * x + c * y, plain);
        const oracle::Field exact({x, y, medium.xi, medium.eta});
        for (int q = 0; q < oracle::plain_quantities; ++q) {
            const auto quantity = static_cast<Quantity>(q);
            const auto truth = turned_exactly(oracle::components(exact, quantity), source.heading);
            CAPTURE(oracle::name(quantity), x, y, source.heading);
            // The offset carries the rounding of coordinates up to 6, 1e-15, over r, times the steepness (two
            // powers).
            CHECK(oracle::relative_error(oracle::components(lab, quantity), truth) <
                  2e-14 / std::hypot(x, y));
        }
    }
}

TEST_CASE("turning the wrong way is seen") {
    const elastic::Field field({.eta = 1.0, .xi = 1.0});
    const FieldValues lab = lab_field(field, {0.0, 0.0, 0.3}, 1.0, 0.5, plain);
    const oracle::Field exact({1.0, 0.5, 1.0, 1.0});
    const auto truth = turned_exactly(oracle::components(exact, Quantity::strain), -0.3);
    CHECK(oracle::relative_error(oracle::components(lab, Quantity::strain), truth) >
          1e-2); // of order the angle
}

TEST_CASE("a quarter turn swaps the axes") {
    const Vector v = turned(Vector{1.0, 2.0}, 0.0, 1.0);
    CHECK((v.x == -2.0 && v.y == 1.0));
    const SymmetricTensor t = turned(SymmetricTensor{1.0, 2.0, 3.0}, 0.0, 1.0);
    CHECK((t.xx == 3.0 && t.xy == -2.0 && t.yy == 1.0));
}

TEST_CASE("fields add up, in order") {
    const elastic::Field field({.eta = 1.3, .xi = 2.0});
    const Source sources[] = {{0.0, 0.0, 0.4}, {1.0, -2.0, 2.0}, {-3.0, 0.5, -1.0}};
    FieldValues sum;
    for (const Source& source : sources) {
        const FieldValues one = lab_field(field, source, 0.7, 0.9, plain);
        sum.displacement.x += one.displacement.x;
        sum.strain.xy += one.strain.xy;
        sum.laplacian.y += one.laplacian.y;
        sum.gradient_of_trace.x += one.gradient_of_trace.x;
        sum.dipole.y += one.dipole.y;
    }
    const FieldValues all = superpose(field, sources, 0.7, 0.9, plain);
    CHECK(all.displacement.x == sum.displacement.x);
    CHECK(all.strain.xy == sum.strain.xy);
    CHECK(all.laplacian.y == sum.laplacian.y);
    CHECK(all.gradient_of_trace.x == sum.gradient_of_trace.x);
    CHECK(all.dipole.y == sum.dipole.y);
    CHECK(superpose(field, {}, 0.7, 0.9, plain).displacement.x == 0.0);
    CHECK_THROWS_AS(superpose(field, sources, 1.0, -2.0, plain), InputError);
}

TEST_CASE("gradients are not turned and so not given in the lab frame") {
    const FieldValues f =
        lab_field(elastic::Field({.eta = 1.0, .xi = 1.0}), {}, 1.0, 0.5, oracle::everything);
    CHECK(std::isnan(f.strain_x.xx));
    CHECK(f.strain.xx != 0.0);
}

// --- Principal axes, checked by multiplying them out

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

// --- Symmetries that hold to the last bit, and the dipole as a limit of monopoles

namespace {

elastic::FieldValues at(const Point& p) {
    return elastic::Field({.eta = p.eta, .xi = p.xi}).at(p.x, p.y, everything);
}

/// Number of y indices of each component, in the order of components(): odd ones change sign with y.
std::vector<int> y_indices(Quantity q) {
    switch (q) {
    case Quantity::strain:
        return {0, 1, 1, 2};
    case Quantity::strain_gradients:
        return {0, 1, 1, 2, 1, 2, 2, 3};
    case Quantity::laplacian_gradients:
    case Quantity::gradient_of_trace_gradients:
        return {0, 1, 1, 2};
    case Quantity::dipole: // of a source with two y indices of its own
    default:
        return {0, 1};
    }
}

bool mirrored(const elastic::FieldValues& up, const elastic::FieldValues& down) {
    for (int k = 0; k < all_quantities; ++k) {
        const auto q = static_cast<Quantity>(k);
        const std::vector<double> a = components(up, q), b = components(down, q);
        for (std::size_t i = 0; i < a.size(); ++i)
            if (a[i] != (y_indices(q)[i] % 2 == 0 ? b[i] : -b[i]))
                return false;
    }
    return true;
}

/// y force dipole from the oracle's y monopole by differences, extrapolated twice: error h^6.
std::vector<Real> dipole_by_difference(const Point& p) {
    const double h = std::ldexp(std::hypot(p.x, p.y) < 1.0 ? 1.0 : p.xi, -8);
    const auto quotient = [&](double d, auto part) {
        return Real((part(oracle::Field({p.x, p.y - d, p.xi, p.eta})) -
                     part(oracle::Field({p.x, p.y + d, p.xi, p.eta}))) /
                    (2 * d));
    };
    const auto limit = [&](auto part) {
        const Real a = quotient(h, part), b = quotient(h / 2, part), c = quotient(h / 4, part);
        return Real((64 * c - 20 * b + a) / 45);
    };
    return {limit([](const oracle::Field& f) { return f.vx(0, 0); }),
            limit([](const oracle::Field& f) { return f.vy(0, 0); })};
}

} // namespace

TEST_CASE("the field is mirrored in its axis to the last bit") {
    RandomStream random(61);
    for (int k = 0; k < 2000; ++k) {
        Point p = random_point(random, k);
        const elastic::FieldValues up = at(p);
        p.y = -p.y;
        CAPTURE(p.x, p.y, p.xi, p.eta);
        CHECK(mirrored(up, at(p)));
    }
}

TEST_CASE("the mirror check can fail") {
    const elastic::FieldValues up = at({0.3, 0.4, 1.0, 1.0});
    elastic::FieldValues down = at({0.3, -0.4, 1.0, 1.0});
    CHECK(mirrored(up, down));
    down.strain.xy = -down.strain.xy;
    CHECK_FALSE(mirrored(up, down));
}

TEST_CASE("the field depends on x/xi only") {
    RandomStream random(62);
    for (int k = 0; k < 500; ++k) {
        const Point p = random_point(random, k);
        const elastic::FieldValues f = at(p), g = at({8.0 * p.x, 8.0 * p.y, 8.0 * p.xi, p.eta});
        CAPTURE(p.x, p.y, p.xi, p.eta);
        if (std::abs(g.laplacian_x.x) < 1e-280)
            continue;                                // near underflow a power of two is not exact
        CHECK(g.displacement.x == f.displacement.x); // to the bit: 8 is a power of two
        CHECK(8.0 * g.strain.xx == f.strain.xx);
        CHECK(64.0 * g.laplacian.x == f.laplacian.x);
        CHECK(8.0 * g.dipole.x == f.dipole.x);
        CHECK(512.0 * g.laplacian_x.x == f.laplacian_x.x);
    }
    const elastic::FieldValues f = at({0.3, 0.2, 1.0, 2.0}), g = at({0.9, 0.6, 3.0, 2.0});
    CHECK(g.displacement.x == Approx(f.displacement.x).epsilon(1e-14)); // rounding of 0.9/3
}

TEST_CASE("the dipole is the limit of two monopoles along y, and by reciprocity its x part is -eps_yy") {
    RandomStream random(63);
    for (int k = 0; k < 40; ++k) {
        const double r = random.log_uniform(1.0, 20.0), angle = random.uniform(-3.1, 3.1);
        const Point p{r * std::cos(angle), r * std::sin(angle), 1.0, random.log_uniform(0.1, 10.0)};
        const elastic::FieldValues f = at(p);
        CAPTURE(p.x, p.y, p.eta);
        CHECK(relative_error(components(f, Quantity::dipole), dipole_by_difference(p)) <
              1e-12); // h^6 = 2^-48, U(7)/7!
        CHECK(f.dipole.x == -f.strain.yy);
    }
    const elastic::FieldValues f = at({1.0, 2.0, 1.0, 1.0});
    CHECK(relative_error(components(f, Quantity::dipole), dipole_by_difference({1.0, 2.0, 1.0, 1.001})) >
          1e-6);
}
