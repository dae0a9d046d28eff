#include "periodic_local.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

constexpr double pi = std::numbers::pi;

/// phi = (e^-p - 1 + p)/p^2 and its slope.
struct Phi {
    double value, slope;
};

Phi phi(double p) {
    if (std::abs(p) >= 1.0) {
        const double one = -std::expm1(-p) / p, two = (1.0 - one) / p;
        return {two, (one - 2.0 * two) / p};
    }
    Phi sum{0.0, 0.0};
    double term = 0.5, before = 0.0; // (-p)^k/(k+2)!, and that over -p
    for (int k = 0; k < 18; ++k) {
        sum.value += term;
        sum.slope -= k * before;
        before = term / (k + 3);
        term *= -p / (k + 3);
    }
    return sum;
}

/// (I0 - 1)/t with I0 of 2 sqrt(t), and its slope.
Phi rest_of_bessel(double t) {
    Phi sum{1.0, 0.0};
    double before = 1.0; // t^(k-1)/k!^2
    for (int k = 2; k < 24 && before > 1e-18; ++k) {
        const double step = before / (k * k);
        sum.slope += (k - 1) * step;
        before = step * t;
        sum.value += before;
    }
    return sum;
}

} // namespace

double bessel_rest(double t) { return rest_of_bessel(t).value; }

double bessel_ratio(int m, double t) {
    double term = 1.0, sum = 1.0;
    for (int k = 1; k < 60 && term > 1e-18 * sum; ++k) {
        term *= t / (k * (m + k));
        sum += term;
    }
    return sum;
}

UniformValue uniform_value(double c, double x, double y) {
    const double rr = x * x + y * y, p = c * x, t = 0.25 * c * c * rr, e = std::exp(-p);
    const Phi f = phi(p), j = rest_of_bessel(t);
    return {pi * (x * x * f.value + 0.25 * e * rr * j.value),
            pi * (x * x * x * f.slope + 0.25 * e * rr * (0.5 * c * rr * j.slope - x * j.value)),
            -pi * y * (x * (1.0 - p * f.value) - 0.25 * c * e * rr * j.value)};
}

namespace {

/// Third derivatives of P. Those of exp(-p) I0 over c^2 exp(-p), b_m = bessel_ratio(m, t).
void add_third(Jets& sum, double c, double x, double y, const std::array<double, 5>& b) {
    const double cc = c * c, p = c * x, q = c * y, scale = pi * std::exp(-p);
    const double t_c = 0.5 * c * (x * x + y * y), b0_c = b[1] * t_c, b1_c = b[2] * t_c / 2.0,
                 b2_c = b[3] * t_c / 3.0, b3_c = b[4] * t_c / 4.0;
    const double one = 1.5 * (p - 1.0), two = 0.375 * p * (1.0 - p), three = p * p * p / 48.0;
    const double xxx = c * (one * b[1] - b[0] + two * b[2] + three * b[3]);
    const double xxy = 0.5 * q * c * (b[1] + (0.25 - 0.5 * p) * b[2] + p * p / 24.0 * b[3]);
    const double xyy = c * (0.125 * (p - q * q) * b[2] - 0.5 * b[1] + p * q * q / 48.0 * b[3]);
    const double yyy = q * c * (0.375 * b[2] + q * q / 48.0 * b[3]);
    sum.g.xxx = scale * xxx;
    sum.g.xxy = scale * xxy;
    sum.g.xyy = scale * xyy;
    sum.g.yyy = scale * yyy;
    // by c: of the polynomials in p and q, of the b, of exp(-p)
    sum.by_c.xxx =
        scale * ((3.0 * p - 1.5) * b[1] - b[0] + (0.75 - 1.125 * p) * p * b[2] + 4.0 * three * b[3] +
                 c * (one * b1_c - b0_c + two * b2_c + three * b3_c) - x * xxx);
    sum.by_c.xxy = scale * (0.5 * q * (2.0 * b[1] + (0.5 - 1.5 * p) * b[2] + p * p / 6.0 * b[3]) +
                            0.5 * cc * y * (b1_c + (0.25 - 0.5 * p) * b2_c + p * p / 24.0 * b3_c) - x * xxy);
    sum.by_c.xyy =
        scale * ((0.25 * p - 0.375 * q * q) * b[2] - 0.5 * b[1] + p * q * q / 12.0 * b[3] +
                 c * (0.125 * (p - q * q) * b2_c - 0.5 * b1_c + p * q * q / 48.0 * b3_c) - x * xyy);
    sum.by_c.yyy = scale * (q * (0.75 * b[2] + q * q / 12.0 * b[3]) +
                            q * c * (0.375 * b2_c + q * q / 48.0 * b3_c) - x * yyy);
}

} // namespace

Jets uniform_part(double c, double x, double y, bool third) {
    const double rr = x * x + y * y, p = c * x, t = 0.25 * c * c * rr, e = std::exp(-p);
    const double b0 = bessel_ratio(0, t), b1 = bessel_ratio(1, t), b2 = bessel_ratio(2, t),
                 b3 = bessel_ratio(3, t), cc = c * c, t_c = 0.5 * c * rr;
    const Phi f = phi(p), j = rest_of_bessel(t);
    const UniformValue value = uniform_value(c, x, y);
    const double one = 1.0 - p * f.value, one_slope = -f.value - p * f.slope; // (1 - e^-p)/p
    const double xx = b0 - p * b1 + 0.5 * b1 + 0.125 * cc * x * x * b2,
                 xy = y * (0.125 * cc * x * b2 - 0.5 * c * b1), yy = 0.5 * b1 + 0.125 * cc * y * y * b2;
    const Jet g{value.g,
                pi * (x * one + e * (0.5 * x * b1 - 0.25 * c * rr * j.value)),
                pi * e * 0.5 * y * b1,
                pi * e * xx,
                pi * e * xy,
                pi * e * yy};
    const double b0_c = b1 * t_c, b1_c = 0.5 * b2 * t_c, b2_c = b3 * t_c / 3.0;
    const double xx_c = b0_c - x * b1 - p * b1_c + 0.5 * b1_c + 0.25 * c * x * x * b2 +
                        0.125 * cc * x * x * b2_c,
                 xy_c = y * (0.25 * c * x * b2 + 0.125 * cc * x * b2_c - 0.5 * b1 - 0.5 * c * b1_c),
                 yy_c = 0.5 * b1_c + 0.25 * c * y * y * b2 + 0.125 * cc * y * y * b2_c;
    const double x_c = x * x * one_slope + e * (0.5 * x * (b1_c - x * b1) -
                                                0.25 * rr * ((1.0 - p) * j.value + c * j.slope * t_c));
    Jets sum{g,
             {value.by_c, pi * x_c, pi * e * 0.5 * y * (b1_c - x * b1), pi * e * (xx_c - x * xx),
              pi * e * (xy_c - x * xy), pi * e * (yy_c - x * yy)}};
    if (third)
        add_third(sum, c, x, y, {b0, b1, b2, b3, bessel_ratio(4, t)});
    return sum;
}

} // namespace rodwake::elastic
