// The oracle itself: the medium's equation, which it does not use, and helpers that must be able to fail.

#include "error_norm.hpp"
#include "sample.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <catch2/catch.hpp>
#include <limits>

using namespace rodwake;
using namespace rodwake::oracle;

namespace {

/// |-(1/xi) d_x U - lap U - eta grad div U| over the sum of the sizes of its parts, for a force along x or y.
template<class X, class Y>
Real residual(const X& ux, const Y& uy, const Point& p) {
    const Real xi = p.xi, eta = p.eta;
    const Real x[] = {ux(1, 0) / xi, ux(2, 0), ux(0, 2), eta * ux(2, 0), eta * uy(1, 1)};
    const Real y[] = {uy(1, 0) / xi, uy(2, 0), uy(0, 2), eta * ux(1, 1), eta * uy(0, 2)};
    Real sum_x = 0, sum_y = 0, scale = 0;
    for (int k = 0; k < 5; ++k) {
        sum_x += x[k];
        sum_y += y[k];
        scale += abs(x[k]) + abs(y[k]);
    }
    return (abs(sum_x) + abs(sum_y)) / scale;
}

Real residual_x(const Point& p, const Field& f) {
    return residual([&](int i, int j) { return f.ux(i, j); }, [&](int i, int j) { return f.uy(i, j); }, p);
}

Real residual_y(const Point& p, const Field& f) {
    return residual([&](int i, int j) { return f.vx(i, j); }, [&](int i, int j) { return f.vy(i, j); }, p);
}

} // namespace

TEST_CASE("the oracle solves the medium's equation for both forces") {
    RandomStream random(11);
    for (int k = 0; k < 200; ++k) {
        const Point p = random_point(random, k);
        const Field f(p);
        CAPTURE(p.x, p.y, p.xi, p.eta);
        if (f.ux(1, 0) == 0)
            continue; // decayed past every exponent
        CHECK(residual_x(p, f) <
              1e-30); // 220 digits less the cancellation of third derivatives at r/xi = 1e-12
        CHECK(residual_y(p, f) < 1e-30); // the same
    }
}

TEST_CASE("the residual sees a wrong medium") {
    const Point p{0.3, -0.4, 2.0, 1.5};
    const Field f(p);
    CHECK(residual_x({p.x, p.y, p.xi, 1.5000001}, f) > 1e-9);  // eta off by 1e-7
    CHECK(residual_x({p.x, p.y, 2.0000001, p.eta}, f) > 1e-9); // xi off by 1e-7
}

TEST_CASE("the oracle's Bessel functions agree with Boost's and across the switch of series") {
    for (const double z : {1e-12, 0.3, 1.0, 7.0, 50.0, 139.0, 141.0, 600.0}) {
        const ScaledPair k = scaled_bessel(z);
        const double decay = std::exp(-z), tolerance = 1e-13; // exp(-600) in double costs 600/2 ulp
        CHECK(std::abs(static_cast<double>(k.k0) * decay / boost::math::cyl_bessel_k(0, z) - 1.0) <
              tolerance);
        CHECK(std::abs(static_cast<double>(k.k1) * decay / boost::math::cyl_bessel_k(1, z) - 1.0) <
              tolerance);
    }
    // K1 = -K0' across z = 140, by a fourth difference that reads both series: h^4/30 f''''' = 1e-41 of K0.
    const Real h = Real(1) / Real("1e10"), z = 140;
    const auto k0 = [](const Real& at) { return Real(exp(-(at - 140)) * scaled_bessel(at).k0); };
    const Real slope = (8 * (k0(z + h) - k0(z - h)) - (k0(z + 2 * h) - k0(z - 2 * h))) / (12 * h);
    CHECK(abs(slope / scaled_bessel(z).k1 + 1) < 1e-38); // the truncation above, with room
}

TEST_CASE("the relative error can fail") {
    const std::vector<Real> exact{3, 4};
    CHECK(relative_error({3.0, 4.0}, exact) == 0.0);
    CHECK(relative_error({3.0, 4.5}, exact) == Approx(0.1));
    CHECK(relative_error({3.0}, exact) == std::numeric_limits<double>::infinity());
    CHECK(relative_error({3.0, std::nan("")}, exact) == std::numeric_limits<double>::infinity());
    Worst worst;
    worst.include(Quantity::strain, std::numeric_limits<double>::infinity(), {});
    worst.include(Quantity::strain, 0.5, {});
    CHECK(worst.error[static_cast<int>(Quantity::strain)] == std::numeric_limits<double>::infinity());
}

TEST_CASE("random points reach the corners they are drawn for") {
    RandomStream random(12);
    for (int k = 0; k < 300; ++k) {
        const Point axis = random_point(random, Angle::axes, Stiffness::zero);
        CHECK((axis.x == 0.0) != (axis.y == 0.0));
        CHECK(axis.eta == 0.0);
        const Point wake = random_point(random, Angle::near_wake, Stiffness::negative);
        CHECK((wake.x < 0.0 && std::abs(wake.y) < 0.11 * std::abs(wake.x) && wake.eta < 0.0));
        CHECK(random_point(random, Angle::near_front, Stiffness::decades).x > 0.0);
    }
    int large = 0;
    for (int k = 0; k < 300; ++k) {
        const Point p = random_point(random, Angle::large_exponent, Stiffness::decades);
        large += (p.x + std::hypot(p.x, p.y)) / (2.0 * p.xi) > 300.0;
    }
    CHECK(large > 50); // drawn evenly up to 760 wherever r is large enough for it
}
