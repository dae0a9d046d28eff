#pragma once
// The periodic potential as columns of sources at x = 0, +-X, ...: a Fourier series along the columns (y,
// period Y), exact exponentials across them. X, Y: the box's sides in units of the shorter one.
//
//   g'' - q^2 g + 2 cx g' + 2 i cy q g = -(2 pi/Y) (delta_per(x) - [q = 0]/X),    q = 2 pi n/Y
//
//   0 < x < X:  g = (pi/s Y) [ e^(k- x)/(1 - e^(k- X)) + e^(k+ (x-X))/(1 - e^(-k+ X)) ]
//
//   k = -cx +- s,    s = sqrt(cx^2 + q^2 - 2 i cy q)
//
// The first is all columns at x <= 0, the second all at x >= X. n = 0: the mean over y (periodic_rows.cpp).
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

class PeriodicRows {
public:
    /// For points at least `nearest` away from the columns that take part.
    PeriodicRows(const WaveVector& c, const PeriodicBox& box, double nearest);

    /// All columns; nearest <= x <= X - nearest.
    void add_all(WaveVectorJets& sum, double x, double y, Needed needed) const;
    /// All but the column at 0; |x| <= X/2.
    void add_others(WaveVectorJets& sum, double x, double y, Needed needed) const;
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
    void add_side(WaveVectorJets& sum, const std::vector<Term>& terms, double u, double y,
                  Needed needed) const;

    double cx_, wx_, wy_;
    PeriodicBox box_;
    double wave_;                      ///< 2 pi/Y
    std::vector<Term> behind_, ahead_; ///< k-, k+; n = 1, 2, ...
};

} // namespace rodwake::elastic
