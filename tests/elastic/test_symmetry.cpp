// Symmetries that hold to the last bit, and the dipole as a limit of monopoles.

#include "error_norm.hpp"
#include "sample.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rodwake;
using namespace rodwake::oracle;

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
        return Real((part(Field({p.x, p.y - d, p.xi, p.eta})) - part(Field({p.x, p.y + d, p.xi, p.eta}))) /
                    (2 * d));
    };
    const auto limit = [&](auto part) {
        const Real a = quotient(h, part), b = quotient(h / 2, part), c = quotient(h / 4, part);
        return Real((64 * c - 20 * b + a) / 45);
    };
    return {limit([](const Field& f) { return f.vx(0, 0); }),
            limit([](const Field& f) { return f.vy(0, 0); })};
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
