#pragma once
// Complex arithmetic without the library's care for infinities, which costs more than the arithmetic.

#include <cmath>
#include <complex>

namespace rodwake::elastic {

using Complex = std::complex<double>;

inline Complex times(Complex a, Complex b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

inline Complex inverse(Complex a) {
    const double scale = 1.0 / (a.real() * a.real() + a.imag() * a.imag());
    return {scale * a.real(), -scale * a.imag()};
}

inline Complex exponential(Complex a) {
    const double e = std::exp(a.real());
    return a.imag() == 0.0 ? Complex{e, 0.0} : Complex{e * std::cos(a.imag()), e * std::sin(a.imag())};
}

/// Root of positive real part; Re a > 0.
inline Complex root(Complex a) {
    if (a.imag() == 0.0)
        return std::sqrt(a.real());
    const double re = std::sqrt(0.5 * (std::sqrt(a.real() * a.real() + a.imag() * a.imag()) + a.real()));
    return {re, 0.5 * a.imag() / re};
}

} // namespace rodwake::elastic
