#include "oracle.hpp"

#include <boost/math/constants/constants.hpp>

namespace rodwake::oracle {

namespace {

using Table1 = std::array<Real, 5>;

int factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

Real power(const Real& base, int exponent) {
    return exponent == 0 ? Real(1) : base * power(base, exponent - 1);
}

Table1 powers(const Real& base) {
    Table1 table;
    for (int n = 0; n < 5; ++n)
        table[n] = power(base, n);
    return table;
}

/// Past this exponent every value is below 1e-4000, far under what a double can hold.
constexpr double vanished = 1e4;

Real decay(const Real& exponent) { return exponent > vanished ? Real(0) : exp(-exponent); }

/// e^z ((1/r) d/dr)^n K0(c r), z = c r.
Table1 radial_steps(const Real& r, const Real& c) {
    const Real z = c * r;
    const ScaledPair start = scaled_bessel(z);
    Table1 k{start.k0, start.k1};
    for (int n = 1; n < 4; ++n)
        k[n + 1] = k[n - 1] + 2 * n * k[n] / z;
    for (int n = 0; n < 5; ++n)
        k[n] *= power(-c / r, n);
    return k;
}

/// Coefficient of x^(i - 2k) f^(i - k)(u) in d_x^i f(u), u = x^2/2 + ...
int chain_rule(int i, int k) { return factorial(i) / ((1 << k) * factorial(k) * factorial(i - 2 * k)); }

/// d_x^i d_y^j of a function of u = r^2/2 from its u derivatives.
Real of_radial(const Table1& steps, const Table1& x, const Table1& y, int i, int j) {
    Real sum = 0;
    for (int k = 0; 2 * k <= i; ++k)
        for (int l = 0; 2 * l <= j; ++l)
            sum += chain_rule(i, k) * chain_rule(j, l) * x[i - 2 * k] * y[j - 2 * l] * steps[i + j - k - l];
    return sum;
}

} // namespace

Potential::Potential(const Real& x, const Real& y, const Real& c) {
    const Real r = sqrt(x * x + y * y), e = decay(c * (x + r));
    const Table1 steps = radial_steps(r, c), xs = powers(x), ys = powers(y), cs = powers(-c);
    for (int j = 0; j <= 4; ++j) {
        Table1 column;
        for (int i = 0; i + j <= 4; ++i)
            column[i] = e * of_radial(steps, xs, ys, i, j);
        for (int i = 0; i + j <= 4; ++i) // Leibniz with exp(-c x)
            for (int k = 0; k <= i; ++k)
                table_[i][j] += factorial(i) / (factorial(k) * factorial(i - k)) * cs[k] * column[i - k];
    }
}

Field::Field(double x, double y, const Exactly& medium)
    : xi_(medium.xi), nu_(1 / (1 + medium.eta)), unit_(1 / boost::math::constants::two_pi<Real>()),
      shear_(x, y, 1 / (2 * xi_)), longitudinal_(x, y, nu_ / (2 * xi_)) {}

Real Field::ux(int i, int j) const {
    const Real difference = shear_.derivative(i + 1, j) - longitudinal_.derivative(i + 1, j);
    return unit_ * (shear_.derivative(i, j) + xi_ * difference);
}

Real Field::uy(int i, int j) const {
    return unit_ * xi_ * (shear_.derivative(i, j + 1) - longitudinal_.derivative(i, j + 1));
}

Real Field::trace(int i, int j) const { return unit_ * nu_ * longitudinal_.derivative(i + 1, j); }

Real Field::vx(int i, int j) const { return uy(i, j); }

Real Field::vy(int i, int j) const {
    return unit_ * (shear_.derivative(i, j) + nu_ * longitudinal_.derivative(i, j)) - ux(i, j);
}

} // namespace rodwake::oracle
