#include "bessel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace rodwake::elastic {

namespace {

// Long double throughout: what is rounded to a row of doubles is then good to their last bit. WebAssembly has
// it in software alone, a hundred times slower: from doubles K0 and z K1 - 1 are good to 1e-15 there.
#ifdef __wasm__
using Wide = double;
#else
using Wide = long double;
#endif

constexpr int order = 13; // of the Taylor series at a piece's middle: (1/32)^14 is far below the last bit
using Taylor = std::array<Wide, order + 1>;

/// e^z K0(z) at z0 (1 + u), by powers of u: the trapezoidal rule on e^z K0 = int_0^inf exp(-z (cosh t - 1))
/// dt and its derivatives, all of one sign (DLMF 10.32.9). The step makes the rule exact to 1e-20 for z0
/// >= 1.
Taylor scaled_k0(Wide z0) {
    const Wide step =
        Wide{0.3L} / std::sqrt(std::max(z0, Wide{2.25})); // cosh turns negative at i pi/2: 0.2 at most
    constexpr Wide vanishing = 110.0;                     // W^13 exp(-W)/13! = 1e-31
    Taylor sum{};
    for (int node = 0;; ++node) {
        const Wide half = std::sinh(0.5 * step * static_cast<Wide>(node)), w = 2.0 * z0 * half * half;
        if (w > vanishing)
            return sum;
        Wide term = std::exp(-w) * (node == 0 ? 0.5 * step : step);
        for (int j = 0; j <= order; ++j) {
            sum[j] += term;
            term *= -w / static_cast<Wide>(j + 1);
        }
    }
}

/// Series of F(z) = e^z K0(z) + ln z at 0 (DLMF 10.31.2 times e^z):
///   F = -ln z sum_{k >= 1} p_k z^k + sum_k r_k z^k,   with e^z I0 = sum p_k z^k.
class Ascending {
public:
    Ascending() {
        std::array<Wide, terms> exponential{}, even{}; // e^z; K0 + (ln(z/2) + gamma) I0 by powers of z
        Wide factor = 1.0, harmonic = 0.0;
        exponential[0] = p_[0] = 1.0;
        for (int k = 1; k < terms; ++k) {
            const Wide n = k;
            exponential[k] = exponential[k - 1] / n;
            p_[k] = p_[k - 1] * (2.0 * n - 1.0) / (n * n);
            if (k % 2 == 0) {
                harmonic += 2.0 / n;
                factor /= n * n;
                even[k] = harmonic * factor;
            }
        }
        for (int k = 0; k < terms; ++k) {
            r_[k] = (std::numbers::ln2_v<Wide> - std::numbers::egamma_v<Wide>)*p_[k];
            for (int m = 0; m <= k; ++m)
                r_[k] += even[m] * exponential[k - m];
        }
        for (int k = 0; k < terms; ++k)
            for (int j = 0; j <= order; ++j) {
                power_[k][j] = binomial(k, j);
                for (int m = 1; m <= j; ++m)
                    log_power_[k][j] += (m % 2 == 1 ? 1.0 : -1.0) / static_cast<Wide>(m) * binomial(k, j - m);
            }
    }

    /// F at z0 (1 + u), by powers of u, for z0 <= 1.
    Taylor at(Wide z0) const {
        const Wide log = std::log(z0);
        Taylor sum{};
        Wide z = 1.0; // z0^k
        for (int k = 0; k < terms && z > Wide{1e-40L}; ++k, z *= z0)
            for (int j = 0; j <= order; ++j) {
                const Wide with_log = k == 0 ? 0.0 : p_[k] * (log * power_[k][j] + log_power_[k][j]);
                sum[j] += z * (r_[k] * power_[k][j] - with_log);
            }
        return sum;
    }

private:
    static constexpr int terms = 28; // p_28 = 1e-21

    static Wide binomial(int n, int k) {
        Wide product = 1.0;
        for (int i = 0; i < k; ++i)
            product *= static_cast<Wide>(n - i) / static_cast<Wide>(i + 1);
        return product;
    }

    std::array<Wide, terms> p_{}, r_{};
    std::array<Taylor, terms> power_{}, log_power_{}; ///< of (1 + u)^k and of (1 + u)^k ln(1 + u)
};

/// Chebyshev polynomials T_0, T_1, ... by powers.
constexpr std::array<Taylor, order> chebyshev = [] {
    std::array<Taylor, order> t{};
    t[0][0] = t[1][1] = 1.0;
    for (int n = 2; n < order; ++n)
        for (int j = 0; j <= order; ++j)
            t[n][j] = (j > 0 ? 2.0 * t[n - 1][j - 1] : 0.0) - t[n - 2][j];
    return t;
}();

/// Coefficients in t of the piece whose middle is m_i 2^binade.
Taylor piece(const Ascending& ascending, int binade, Wide middle, Wide half_width, int terms) {
    const Wide z = std::ldexp(middle, binade), farthest = half_width / (middle - half_width); // |t|
    const Taylor in_u = binade < 0 ? ascending.at(z) : scaled_k0(z);

    // From u = t/(1 - t) to powers of t: u^j = sum_k C(k - 1, j - 1) t^k.
    Taylor series{};
    series[0] = in_u[0];
    for (int j = 1; j <= order; ++j) {
        Wide binomial = 1.0;
        for (int k = j; k <= order; ++k) {
            series[k] += binomial * in_u[j];
            binomial *= static_cast<Wide>(k) / static_cast<Wide>(k - j + 1);
        }
    }
    if (binade < 0)
        series[0] -= std::log(z);
    Wide scale = 1.0;
    for (Wide& term : series) {
        term *= scale;
        scale *= farthest;
    }

    // The series, by powers of x in [-1, 1], gets `terms` terms: its derivative is economised (the highest
    // powers are traded for Chebyshev polynomials), since errors of the derivative are the larger ones.
    for (int n = order - 1; n >= terms - 1; --n) {
        const Taylor& t = chebyshev[n];
        const Wide surplus = static_cast<Wide>(n + 1) * series[n + 1] / t[n];
        for (int j = 0; j <= n; ++j)
            series[j + 1] -= surplus * t[j] / static_cast<Wide>(j + 1);
    }
    scale = 1.0;
    for (Wide& term : series) {
        term *= scale;
        scale /= farthest;
    }
    return series;
}

} // namespace

template<class Real>
BesselTable<Real> make_bessel_table(TableShape shape) {
    static const Ascending ascending;
    const int pieces = 1 << shape.piece_bits;
    const Wide half_width = 0.5 / static_cast<Wide>(pieces);
    BesselTable<Real> table;
    const auto rows = static_cast<std::size_t>(end_binade - lowest_binade) * static_cast<std::size_t>(pieces);
    table.coefficients.reserve(rows * static_cast<std::size_t>(shape.stride()));
    for (int binade = lowest_binade; binade < end_binade; ++binade)
        for (int i = 0; i < pieces; ++i) {
            const Wide middle = 1.0 + half_width * static_cast<Wide>(2 * i + 1);
            const Taylor row = piece(ascending, binade, middle, half_width, shape.terms);
            for (int k = 0; k < shape.stride(); ++k)
                table.coefficients.push_back(k < shape.terms ? static_cast<Real>(row[k]) : Real{0});
        }
    return table;
}

template BesselTable<double> make_bessel_table<double>(TableShape);
template BesselTable<float> make_bessel_table<float>(TableShape);

const BesselTable<double>& bessel_table() {
    static const BesselTable<double> table = make_bessel_table<double>(full_shape);
    return table;
}

const BesselTable<double>& fine_bessel_table() {
    static const BesselTable<double> table = make_bessel_table<double>(fine_shape);
    return table;
}

const BesselTable<float>& single_bessel_table() {
    static const BesselTable<float> table = make_bessel_table<float>(single_shape);
    return table;
}

namespace {

#include "bessel_tail.inc"

constexpr int series_terms = 8; // next term at z = 1/2: (1/16)^8/(8!)^2 = 1e-19

/// Coefficients in t = z^2/4 of I0, of K0's regular part, of 2 I1/z and of K1's regular part
/// (DLMF 10.25.2, 10.31.1-2).
struct BesselSeries {
    std::array<double, series_terms> i0, k0, i1, k1;
};

constexpr BesselSeries make_series() {
    BesselSeries s{};
    double factorial = 1.0, harmonic = 0.0;
    for (int k = 0; k < series_terms; ++k) {
        if (k > 0) {
            factorial *= k;
            harmonic += 1.0 / k;
        }
        const double next = factorial * (k + 1);
        s.i0[k] = 1.0 / (factorial * factorial);
        s.k0[k] = harmonic / (factorial * factorial);
        s.i1[k] = 1.0 / (factorial * next);
        s.k1[k] = (2.0 * harmonic + 1.0 / (k + 1)) / (factorial * next);
    }
    return s;
}

constexpr BesselSeries series = make_series();

Pair horner(const std::array<double, series_terms>& c, Pair t) {
    Pair sum = t * c[series_terms - 1] + c[series_terms - 2];
    for (int k = series_terms - 3; k >= 0; --k)
        sum = sum * t + c[k];
    return sum;
}

} // namespace

CoreBessel core_bessel(Pair z, Pair log_half) {
    const Pair t = 0.25 * z * z, log_term = log_half + std::numbers::egamma;
    return {horner(series.k0, t) - log_term * horner(series.i0, t),
            0.5 * z * (log_term * horner(series.i1, t) - 0.5 * horner(series.k1, t))};
}

Bessel plain_bessel(double z) {
    const double log_half = std::log(0.5 * z);
    const CoreBessel core = core_bessel(Pair{z, z}, Pair{log_half, log_half});
    const double inverse = 1.0 / z, k0 = core.k0[0], k1 = core.kappa1[0] + inverse, d1 = k1 - k0;
    return {k0, k1, d1, k1 * inverse - 2.0 * d1};
}

Bessel scaled_bessel(double t, double root) {
    // The piece of the fits that holds t = 1/z < 2, from the exponent and the first bit of the mantissa: no
    // branch.
    constexpr int half_octave = 51,
                  first = static_cast<int>(std::bit_cast<std::uint64_t>(0x1p-4) >> half_octave);
    const int index = static_cast<int>(std::bit_cast<std::uint64_t>(t) >> half_octave) - first + 1;
    const TailPiece& at = tail[index > 0 ? index : 0];

    // Degree 13 in seven chains of two: a third of Horner's latency.
    const Pair* c = at.power;
    const double u = at.slope * t + at.offset, u2 = u * u, u4 = u2 * u2;
    const auto chain = [&](int k) { return c[k] + u * c[k + 1]; };
    const Pair low = chain(0) + u2 * chain(2), middle = chain(4) + u2 * chain(6),
               high = chain(8) + u2 * chain(10);
    const Pair sum = low + u4 * (middle + u4 * (high + u4 * chain(12)));
    const double d1 = 0.5 * t * root * sum[0], d2 = 0.75 * t * t * root * sum[1];
    const double k1 = root * (sum[0] + 0.75 * t * sum[1]);
    return {k1 - d1, k1, d1, d2};
}

} // namespace rodwake::elastic
