#pragma once
// The periodic potential as columns of sources at x = 0, +-1, ...: a Fourier series along the columns (y),
// exact exponentials across them. Unit of length: the box's side. The rod heads along (ux, uy).
//
//   g'' - q^2 g + 2 cx g' + 2 i cy q g = -2 pi (delta_per(x) - [q = 0]),    q = 2 pi n,  (cx, cy) = c (ux,
//   uy) k = -cx +- s,  s = sqrt(cx^2 + q^2 - 2 i cy q) 0 < x < 1:  g = (pi/s) [ e^(k- x)/(1 - e^(k-)) + e^(k+
//   (x-1))/(1 - e^(-k+)) ]
//
// The first is all columns at x <= 0, the second all at x >= 1. n = 0: periodic_mean.hpp. The sum over n
// converges as e^(-Re k d), d the distance of the nearest column that takes part; terms below e^-37 are left
// out.

#include "periodic_complex.hpp"
#include "periodic_jet.hpp"

#include <vector>

namespace rodwake::elastic {

class Rows {
public:
    /// For points at least `nearest` away from the columns that take part.
    Rows(double c, double ux, double uy, double nearest);

    /// All columns; nearest <= x <= 1 - nearest.
    void add_all(Jets& sum, double x, double y, Needed needed) const;
    /// All but the column at 0; |x| <= 1/2.
    void add_others(Jets& sum, double x, double y, Needed needed) const;
    /// Values alone, at (x, y) and (x, -y), of the potential and its derivative by c.
    struct Values {
        double g, by_c;
    };
    struct Mirrored {
        Values upper, lower;
    };
    Mirrored values(double x, double y) const;

private:
    /// weight e^(k u) with the derivatives by c of both.
    struct Term {
        Complex k, weight, k_c, weight_c;
    };
    Term term(Complex k, Complex s, double q, double towards) const;
    void add_side(Jets& sum, const std::vector<Term>& terms, double u, double y, Needed needed) const;

    double c_, ux_, uy_;
    std::vector<Term> behind_, ahead_; ///< k-, k+; n = 1, 2, ...
};

} // namespace rodwake::elastic
