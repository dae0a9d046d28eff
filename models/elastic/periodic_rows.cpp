#include "periodic_rows.hpp"

#include "periodic_local.hpp"

#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace rodwake::elastic {

namespace {

// The mean over y of the periodic potential, a function of x alone (n = 0 of the series). Of the square, with
// z = 2 cx:
//
//   g'' + z g' = -2 pi (delta_per(x) - 1),    g = (2 pi/z) [x - 1/2 - 1/z + e^(-z x)/(1 - e^-z)],  0 < x < 1
//
// of zero mean over the box. For small z the sum 2 pi sum_n (-z)^(n-2) B_n(x)/n! of Bernoulli polynomials. Of
// a rectangle X/Y times that of x/X and z = 2 cx X.

/// Derivatives by x and by z.
struct Mean {
    double g, x, xx, z, xz, xxz;
};

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr int orders = 20; // (1/2 pi)^20 = 1e-16

/// B_n/n!
constexpr std::array<double, orders> bernoulli = {1.0,
                                                  -1.0 / 2.0,
                                                  1.0 / 12.0,
                                                  0.0,
                                                  -1.0 / 720.0,
                                                  0.0,
                                                  1.0 / 30240.0,
                                                  0.0,
                                                  -1.0 / 1209600.0,
                                                  0.0,
                                                  1.0 / 47900160.0,
                                                  0.0,
                                                  -691.0 / 1307674368000.0,
                                                  0.0,
                                                  1.0 / 74724249600.0,
                                                  0.0,
                                                  -3617.0 / 10670622842880000.0,
                                                  0.0,
                                                  43867.0 / 5109094217170944000.0,
                                                  0.0};

/// (2 pi/z) [line - 1/z + E(x)], E = e^(-z x)/(1 - e^-z), `line` rising as x.
Mean closed(double z, double line, double x) {
    const double less = 1.0 / std::expm1(-std::abs(z)); // E = e^(z (1-x))/(e^z - 1)
    const double e = z > 0.0 ? -std::exp(-z * x) * less : std::exp(z * (1.0 - x)) * less;
    const double e_z = -e * (x + (z > 0.0 ? -1.0 - less : less)), scale = two_pi / z;
    const double g = scale * (line - 1.0 / z + e), g_x = scale * (1.0 - z * e);
    return {g,
            g_x,
            two_pi * z * e,
            scale * (1.0 / (z * z) + e_z) - g / z,
            -scale * (e + z * e_z) - g_x / z,
            two_pi * (e + z * e_z)};
}

/// Of all columns, 0 <= x <= 1; any z.
Mean mean_of_all(double z, double x) {
    if (std::abs(z) >= 1.0)
        return closed(z, x - 0.5, x);
    std::array<double, orders> power_of_x{1.0}, b{}; // b: B_n(x)/n!
    for (int n = 1; n < orders; ++n)
        power_of_x[n] = power_of_x[n - 1] * x / n;
    for (int n = 0; n < orders; ++n) {
        b[n] = n > 0 ? power_of_x[n] - 0.5 * power_of_x[n - 1] : 1.0;
        for (int k = n - 2; k >= 0; k -= 2) // the odd Bernoulli numbers are 0
            b[n] += power_of_x[k] * bernoulli[n - k];
    }
    Mean sum{};
    double power = two_pi, slope = 0.0; // 2 pi (-z)^j and its derivative by z
    for (int j = 0; j + 2 < orders; ++j) {
        sum.g += power * b[j + 2];
        sum.x += power * b[j + 1];
        sum.xx += power * b[j];
        sum.z += slope * b[j + 2];
        sum.xz += slope * b[j + 1];
        sum.xxz += slope * b[j];
        slope = -power - z * slope;
        power *= -z;
    }
    return sum;
}

constexpr double row_cutoff = 37.0;

/// 1 - e^a for Re a < 0, accurate for small a.
Complex one_minus_exp(Complex a) {
    if (a.real() < -row_cutoff)
        return 1.0;
    const double less = std::expm1(a.real());
    if (a.imag() == 0.0)
        return -less;
    const double half = std::sin(0.5 * a.imag()), e = 1.0 + less;
    return {-less + 2.0 * e * half * half, -e * std::sin(a.imag())};
}

/// From a mean by x/X and z to one by x and cx.
Mean in_box(Mean m, const PeriodicBox& box) {
    const double v = box.x / box.y, x = v / box.x, xx = x / box.x, by_cx = 2.0 * box.x;
    return {v * m.g, x * m.x, xx * m.xx, by_cx * v * m.z, by_cx * x * m.xz, by_cx * xx * m.xxz};
}

/// xxx = -2 cx xx by the equation.
void add(WaveVectorJets& sum, const Mean& m, double cx, double wx) {
    const double decay = 2.0 * cx;
    sum.g.v += m.g;
    sum.g.x += m.x;
    sum.g.xx += m.xx;
    sum.g.xxx -= decay * m.xx;
    sum.by_c.v += wx * m.z;
    sum.by_c.x += wx * m.xz;
    sum.by_c.xx += wx * m.xxz;
    sum.by_c.xxx -= wx * (2.0 * m.xx + decay * m.xxz);
}

void add_term(Jet& sum, Complex t, Complex tx, Complex txx, double q, bool second) {
    sum.v += t.real();
    sum.x += tx.real();
    sum.y -= q * t.imag();
    if (!second)
        return;
    sum.xx += txx.real();
    sum.xy -= q * tx.imag();
    sum.yy -= q * q * t.real();
}

void add_third(Jet& sum, Complex t, Complex tx, Complex txx, Complex txxx, double q) {
    sum.xxx += txxx.real();
    sum.xxy -= q * txx.imag();
    sum.xyy -= q * q * tx.real();
    sum.yyy += q * q * q * t.imag();
}

} // namespace

/// One column gives (pi/s Y) e^(k u); `towards` -1 for k-, 1 for k+. Twice the real part is both n and -n.
PeriodicRows::Term PeriodicRows::term(Complex k, Complex s, double q, double towards) const {
    const Complex per_s = inverse(s), slope = -towards * times(wx_ * k + Complex(0.0, wy_ * q), per_s);
    const Complex s_slope = times(Complex(cx_ * wx_, -wy_ * q), per_s);
    const Complex open = one_minus_exp(-towards * box_.x * k), per_open = inverse(open);
    const Complex weight = wave_ * times(per_s, per_open);
    const Complex closing = -towards * box_.x * times(slope, times(1.0 - open, per_open));
    return {k, weight, slope, times(weight, closing - times(s_slope, per_s))};
}

PeriodicRows::PeriodicRows(const WaveVector& c, const PeriodicBox& box, double nearest)
    : cx_(c.c * c.ux), wx_(c.wx), wy_(c.wy), box_(box), wave_(two_pi / box.y) {
    const double cy = c.c * c.uy;
    for (double q = wave_;; q += wave_) {
        const Complex product(q * q, -2.0 * cy * q), s = root(cx_ * cx_ + product);
        const Complex large = std::abs(cx_) + s, small = times(product, inverse(large));
        const Complex minus = cx_ >= 0.0 ? -large : -small, plus = cx_ >= 0.0 ? small : large;
        behind_.push_back(term(minus, s, q, -1.0));
        ahead_.push_back(term(plus, s, q, 1.0));
        if (small.real() * nearest > row_cutoff)
            return;
    }
}

void PeriodicRows::add_side(WaveVectorJets& sum, const std::vector<Term>& terms, double u, double y,
                            Needed needed) const {
    const Complex turn(std::cos(wave_ * y), std::sin(wave_ * y));
    Complex phase = turn;
    double q = wave_;
    for (const Term& term : terms) {
        if (std::abs(term.k.real() * u) > row_cutoff)
            break;
        const Complex e = times(phase, exponential(term.k * u)), t = times(term.weight, e);
        const Complex tx = times(term.k, t), txx = times(term.k, tx);
        add_term(sum.g, t, tx, txx, q, needed.second);
        if (needed.third)
            add_third(sum.g, t, tx, txx, times(term.k, txx), q);
        if (needed.by_c) {
            const Complex f = times(term.weight_c, e) + u * times(term.k_c, t), g = times(term.k_c, t);
            const Complex fx = times(term.k, f) + g, fxx = times(term.k, fx + g);
            add_term(sum.by_c, f, fx, fxx, q, needed.second);
            if (needed.third)
                add_third(sum.by_c, f, fx, fxx, times(term.k, fxx + times(term.k, g)), q);
        }
        phase = times(phase, turn);
        q += wave_;
    }
}

void PeriodicRows::add_all(WaveVectorJets& sum, double x, double y, Needed needed) const {
    add(sum, in_box(mean_of_all(2.0 * box_.x * cx_, x / box_.x), box_), cx_, wx_);
    add_side(sum, behind_, x, y, needed);
    add_side(sum, ahead_, x - box_.x, y, needed);
}

void PeriodicRows::add_others(WaveVectorJets& sum, double x, double y, Needed needed) const {
    // Without the infinite plane's column at 0, whose mean is (2 pi/|z|) min(1, e^(-z x)); |x| <= 1/2. For
    // |z| >= 1, else powers of 1/z cancel.
    const double z = 2.0 * box_.x * cx_, place = x / box_.x;
    const Mean mean = z > 0.0 ? closed(z, place - 0.5, place + 1.0) : closed(z, place + 0.5, place);
    add(sum, in_box(mean, box_), cx_, wx_);
    add_side(sum, behind_, x + box_.x, y, needed);
    add_side(sum, ahead_, x - box_.x, y, needed);
}

PeriodicRows::Mirrored PeriodicRows::values(double x, double y) const {
    const Mean mean = in_box(mean_of_all(2.0 * box_.x * cx_, x / box_.x), box_);
    Mirrored sum{{mean.g, wx_ * mean.z}, {mean.g, wx_ * mean.z}};
    const Complex turn(std::cos(wave_ * y), std::sin(wave_ * y));
    for (const bool front : {false, true}) {
        const double u = front ? x - box_.x : x;
        Complex phase = turn;
        for (const Term& term : front ? ahead_ : behind_) {
            if (std::abs(term.k.real() * u) > row_cutoff)
                break;
            const Complex e = exponential(term.k * u), t = times(term.weight, e);
            const Complex f = times(term.weight_c, e) + u * times(term.k_c, t);
            const auto upper = [&](Complex a) { return a.real() * phase.real() - a.imag() * phase.imag(); };
            const auto lower = [&](Complex a) { return a.real() * phase.real() + a.imag() * phase.imag(); };
            sum.upper.g += upper(t);
            sum.lower.g += lower(t);
            sum.upper.by_c += upper(f);
            sum.lower.by_c += lower(f);
            phase = times(phase, turn);
        }
    }
    return sum;
}

namespace {

constexpr double pi = std::numbers::pi;

/// phi = (e^-p - 1 + p)/p^2 and its slope.
struct PhiValue {
    double value, slope;
};

PhiValue phi(double p) {
    if (std::abs(p) >= 1.0) {
        const double one = -std::expm1(-p) / p, two = (1.0 - one) / p;
        return {two, (one - 2.0 * two) / p};
    }
    PhiValue sum{0.0, 0.0};
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
PhiValue rest_of_bessel(double t) {
    PhiValue sum{1.0, 0.0};
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
    const PhiValue f = phi(p), j = rest_of_bessel(t);
    return {pi * (x * x * f.value + 0.25 * e * rr * j.value),
            pi * (x * x * x * f.slope + 0.25 * e * rr * (0.5 * c * rr * j.slope - x * j.value)),
            -pi * y * (x * (1.0 - p * f.value) - 0.25 * c * e * rr * j.value)};
}

namespace {

/// Third derivatives of P. Those of exp(-p) I0 over c^2 exp(-p), b_m = bessel_ratio(m, t).
void add_third(WaveVectorJets& sum, double c, double x, double y, const std::array<double, 5>& b) {
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

WaveVectorJets uniform_part(double c, double x, double y, bool third) {
    const double rr = x * x + y * y, p = c * x, t = 0.25 * c * c * rr, e = std::exp(-p);
    const double b0 = bessel_ratio(0, t), b1 = bessel_ratio(1, t), b2 = bessel_ratio(2, t),
                 b3 = bessel_ratio(3, t), cc = c * c, t_c = 0.5 * c * rr;
    const PhiValue f = phi(p), j = rest_of_bessel(t);
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
    WaveVectorJets sum{g,
                       {value.by_c, pi * x_c, pi * e * 0.5 * y * (b1_c - x * b1), pi * e * (xx_c - x * xx),
                        pi * e * (xy_c - x * xy), pi * e * (yy_c - x * yy)}};
    if (third)
        add_third(sum, c, x, y, {b0, b1, b2, b3, bessel_ratio(4, t)});
    return sum;
}

} // namespace rodwake::elastic
