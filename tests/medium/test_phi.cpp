// phi_k against their integrals, phi_k(z) = int_0^1 e^((1 - s) z) s^(k - 1)/(k - 1)! ds.

#include "medium/phi.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <catch2/catch.hpp>

#include <cmath>
#include <complex>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

using Number = std::complex<double>;

/// Panels of 30 nodes, short enough for |z| <= 60: 1e-15.
Number integral(Number z, int k) {
    Number sum = 0.0;
    constexpr int panels = 8;
    for (int panel = 0; panel < panels; ++panel) {
        const auto part = [&](auto take) {
            return boost::math::quadrature::gauss<double, 30>::integrate(
                [&](double s) {
                    const double power = k == 1 ? 1.0 : k == 2 ? s : 0.5 * s * s;
                    return take(std::exp((1.0 - s) * z) * power);
                },
                static_cast<double>(panel) / panels, static_cast<double>(panel + 1) / panels);
        };
        sum += Number(part([](Number v) { return v.real(); }), part([](Number v) { return v.imag(); }));
    }
    return sum;
}

Number value(Complex c) { return {c.re, c.im}; }

void compare(const Phi& p, Number z) {
    CAPTURE(z);
    constexpr double rounding = 4e-15; // of the recurrence at |z| = 1, as the header says
    CHECK(std::abs(value(p.zero) - std::exp(z)) < rounding);
    CHECK(std::abs(value(p.one) - integral(z, 1)) < rounding);
    CHECK(std::abs(value(p.two) - integral(z, 2)) < rounding);
    CHECK(std::abs(value(p.three) - integral(z, 3)) < rounding);
}

} // namespace

TEST_CASE("phi_k are their integrals, near zero and far, and so are those at twice the argument") {
    for (const double size : {0.0, 1e-9, 0.1, 0.5, 0.99, 1.01, 2.0, 10.0, 30.0})
        for (const double angle : {1.5707963267948966, 1.7, 2.4, 3.1415926535897931, -2.0}) {
            const Number z = std::polar(size, angle), e = std::exp(z);
            const Phi p = phi({z.real(), z.imag()}, {e.real(), e.imag()});
            compare(p, z);
            compare(doubled(p), 2.0 * z);
        }
}
