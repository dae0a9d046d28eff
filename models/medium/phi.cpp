#include "phi.hpp"

#include <array>

namespace rodwake::medium {

namespace {

/// 1/(k + 3)!
constexpr std::array<double, 18> series_of_three = [] {
    std::array<double, 18> c{};
    double term = 1.0 / 6.0;
    for (unsigned k = 0; k < c.size(); ++k, term /= static_cast<double>(k + 3))
        c[k] = term;
    return c;
}();

Phi near_zero(Complex z) {
    Phi p;
    for (unsigned k = series_of_three.size(); k-- > 0;)
        p.three = z * p.three + Complex{series_of_three[k], 0.0};
    p.two = z * p.three + Complex{0.5, 0.0};
    p.one = z * p.two + Complex{1.0, 0.0};
    p.zero = z * p.one + Complex{1.0, 0.0};
    return p;
}

} // namespace

Phi phi(Complex z, Complex exponential) {
    const double norm = z.re * z.re + z.im * z.im;
    if (norm < 1.0)
        return near_zero(z);
    const Complex inverse{z.re / norm, -z.im / norm};
    Phi p{exponential, {}, {}, {}};
    p.one = (p.zero - Complex{1.0, 0.0}) * inverse;
    p.two = (p.one - Complex{1.0, 0.0}) * inverse;
    p.three = (p.two - Complex{0.5, 0.0}) * inverse;
    return p;
}

Phi doubled(const Phi& p) {
    return {p.zero * p.zero, 0.5 * (p.zero * p.one + p.one), 0.25 * (p.zero * p.two + p.one + p.two),
            0.125 * (p.zero * p.three + 0.5 * p.one + p.two + p.three)};
}

} // namespace rodwake::medium
