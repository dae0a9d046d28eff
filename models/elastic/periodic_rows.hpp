#pragma once
// The periodic potential as columns of sources at x = 0, +-1, ...: a Fourier series along the columns (y),
// exact exponentials across them. Unit of length: the box's side.
//
//   g'' - q^2 g + 2 cx g' + 2 i cy q g = -2 pi (delta_per(x) - [q = 0]),    q = 2 pi n
//
//   0 < x < 1:  g = (pi/s) [ e^(k- x)/(1 - e^(k-)) + e^(k+ (x-1))/(1 - e^(-k+)) ]
//
//   k = -cx +- s,    s = sqrt(cx^2 + q^2 - 2 i cy q)
//
// The first is all columns at x <= 0, the second all at x >= 1. n = 0: the mean over y (periodic_rows.cpp).
// The sum over n converges as e^(-Re k d), d the distance of the nearest column that takes part; terms below
// e^-37 are left out.

#include "periodic_jet.hpp"

#include <cmath>
#include <complex>
#include <vector>

namespace rodwake::elastic {

// Complex arithmetic without the library's care for infinities, which costs more than the arithmetic.

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

class Rows {
public:
    /// Wave vector (cx, cy); derivatives by it are along (wx, wy). For points at least `nearest` away from
    /// the columns that take part.
    Rows(double cx, double cy, double wx, double wy, double nearest);

    /// All columns; nearest <= x <= 1 - nearest.
    void add_all(Jets& sum, double x, double y, Needed needed) const;
    /// All but the column at 0; |x| <= 1/2.
    void add_others(Jets& sum, double x, double y, Needed needed) const;
    /// Values alone, at (x, y) and (x, -y), of the potential and its derivative by the wave
    /// vector.
    struct Values {
        double g, by_c;
    };
    struct Mirrored {
        Values upper, lower;
    };
    Mirrored values(double x, double y) const;

private:
    /// weight e^(k u) with the derivatives of both by the wave vector.
    struct Term {
        Complex k, weight, k_c, weight_c;
    };
    Term term(Complex k, Complex s, double q, double towards) const;
    void add_side(Jets& sum, const std::vector<Term>& terms, double u, double y, Needed needed) const;

    double cx_, wx_, wy_;
    std::vector<Term> behind_, ahead_; ///< k-, k+; n = 1, 2, ...
};

} // namespace rodwake::elastic
