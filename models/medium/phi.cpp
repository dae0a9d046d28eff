#include "phi.hpp"

#include <array>
#include <cmath>

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

Phi at(Complex z) {
    const double size = std::exp(z.re);
    return phi(z, {size * std::cos(z.im), size * std::sin(z.im)});
}

Complex four(Complex z, Complex three) {
    const double norm = z.re * z.re + z.im * z.im;
    if (norm >= 1.0)
        return (three - Complex{1.0 / 6.0, 0.0}) * Complex{z.re / norm, -z.im / norm};
    Complex sum;
    for (unsigned k = series_of_three.size() - 1; k > 0; --k)
        sum = z * sum + Complex{series_of_three[k], 0.0};
    return sum;
}

/// Of Gauss and Legendre on [0, 1]; the error of the derivatives below is some 1e-16 for lengths up to 1.
constexpr std::array<double, 6> nodes{0.033765242898423987, 0.16939530676686774, 0.38069040695840155,
                                      0.61930959304159845,  0.83060469323313226, 0.96623475710157601};
constexpr std::array<double, 6> weights{0.085662246189585173, 0.18038078652406930, 0.23395696728634552,
                                        0.23395696728634552,  0.18038078652406930, 0.085662246189585173};

} // namespace

Phi phi(Complex z, Complex exponential) {
    const double norm = z.re * z.re + z.im * z.im;
    Phi p{exponential, {}, {}, {}};
    if (norm < 1.0) {
        for (unsigned k = series_of_three.size(); k-- > 0;)
            p.three = z * p.three + Complex{series_of_three[k], 0.0};
        p.two = z * p.three + Complex{0.5, 0.0};
        p.one = z * p.two + Complex{1.0, 0.0};
        p.zero = z * p.one + Complex{1.0, 0.0};
        return p;
    }
    const Complex inverse{z.re / norm, -z.im / norm};
    p.one = (p.zero - Complex{1.0, 0.0}) * inverse;
    p.two = (p.one - Complex{1.0, 0.0}) * inverse;
    p.three = (p.two - Complex{0.5, 0.0}) * inverse;
    return p;
}

Phi doubled(const Phi& p) {
    return {p.zero * p.zero, 0.5 * (p.zero * p.one + p.one), 0.25 * (p.zero * p.two + p.one + p.two),
            0.125 * (p.zero * p.three + 0.5 * p.one + p.two + p.three)};
}

PhiDifferences phi_differences(Complex a, Complex b) {
    const Complex d = a - b;
    const double norm = d.re * d.re + d.im * d.im;
    if (norm < 1.0) { // the derivatives by quadrature
        PhiDifferences sum{};
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            const Complex z = b + nodes[k] * (a - b);
            const Phi p = at(z);
            sum.zero += weights[k] * p.zero.re;
            sum.one += weights[k] * (p.one.re - p.two.re);
            sum.two += weights[k] * (p.two.re - 2.0 * p.three.re);
            sum.three += weights[k] * (p.three.re - 3.0 * four(z, p.three).re);
        }
        return sum;
    }
    const Complex inverse{d.re / norm, -d.im / norm};
    const Phi p = at(a), q = at(b);
    return {((p.zero - q.zero) * inverse).re, ((p.one - q.one) * inverse).re, ((p.two - q.two) * inverse).re,
            ((p.three - q.three) * inverse).re};
}

} // namespace rodwake::medium
