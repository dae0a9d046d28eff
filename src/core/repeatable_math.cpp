#include "rodwake/core/repeatable_math.hpp"

#include "rodwake/core/periodic.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace rodwake::repeatable {

// Arguments are reduced as usual (Cody and Waite 1980); the polynomials interpolate at Chebyshev points
// (mpmath.chebyfit, 60 digits). They are off by less than 2e-17 of the result.

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

/// Even and odd terms apart, which do not wait for each other; an even number of them.
template<std::size_t n>
double polynomial(const std::array<double, n>& c, double x) {
    static_assert(n % 2 == 0);
    const double square = x * x;
    double even = c[n - 2], odd = c[n - 1];
    for (std::size_t k = n - 2; k > 0; k -= 2) {
        even = even * square + c[k - 2];
        odd = odd * square + c[k - 1];
    }
    return even + x * odd;
}

/// A sum and what its rounding lost.
struct Sum {
    double value, rest;
};

Sum exact_sum(double a, double b) { // Knuth's
    const double value = a + b, part = value - a;
    return {value, (a - (value - part)) + (b - part)};
}

constexpr double widest = 0x1p30; // more quarter turns than 2^30 have no exact products with 22 digits

constexpr std::array sin_series{-0x1.5555555555555p-3, 0x1.1111111110bb1p-7,   -0x1.a01a019e8357dp-13,
                                0x1.71de37961e4c6p-19, -0x1.ae600a926c89ap-26, 0x1.5e0af186af739p-33};
constexpr std::array cos_series{0x1.5555555555555p-5,   -0x1.6c16c16c16966p-10, 0x1.a01a019f4e867p-16,
                                -0x1.27e4fa17a41b4p-22, 0x1.1eeb68b109173p-29,  -0x1.907d7aebd5e3dp-37};

} // namespace

SinCos sin_cos(double x) {
    if (std::abs(x) < 0x1p-27) // often exactly 0
        return {x, 1.0};
    const double y = std::abs(x) < widest ? x : std::remainder(x, 2.0 * std::numbers::pi);
    if (!(std::abs(y) < widest))
        return {nan, nan};
    // The angle is r + rest, at most pi/4, and quarter turns: parts of pi/2 of 22 binary digits, whose
    // multiples are exact, and a rest: 145 digits.
    double r = y, rest = 0.0;
    std::int64_t quarters = 0;
    if (std::abs(y) > 0.25 * std::numbers::pi) {
        const double n = nearest_whole(y * (2.0 / std::numbers::pi));
        const double near = (y - n * 0x1.921fb00000000p+0) - n * 0x1.5110b00000000p-22; // exact
        const Sum third = exact_sum(near, -n * 0x1.1846980000000p-44);
        const Sum fourth = exact_sum(third.value, -n * 0x1.3198a00000000p-69);
        const Sum all = exact_sum(fourth.value, third.rest + (fourth.rest - n * 0x1.701b839a25205p-92));
        r = all.value;
        rest = all.rest;
        quarters = static_cast<std::int64_t>(n);
    }
    const double square = r * r, half = 0.5 * square, w = 1.0 - half;
    const double sine = r + (r * square * polynomial(sin_series, square) + rest * w),
                 cosine =
                     w + (((1.0 - w) - half) + (square * square * polynomial(cos_series, square) - r * rest));
    switch (quarters & 3) {
    case 0:
        return {sine, cosine};
    case 1:
        return {cosine, -sine};
    case 2:
        return {-sine, -cosine};
    default:
        return {-cosine, sine};
    }
}

namespace {

constexpr double ln2_high = 0x1.62e42fefa3800p-1, ln2_low = 0x1.ef35793c76730p-45; // 42 digits; the rest

/// 2^n, -1022 <= n <= 1023.
double power_of_two(std::int64_t n) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(n + 1023) << 52);
}

/// (exp(r) - 1 - r)/r^2.
constexpr std::array exp_series{0x1.0000000000001p-1,  0x1.5555555555556p-3,  0x1.5555555553d63p-5,
                                0x1.11111111109b3p-7,  0x1.6c16c1788bd90p-10, 0x1.a01a01a7c41d5p-13,
                                0x1.a019b90d2ae7ap-16, 0x1.71de0dae63bb3p-19, 0x1.289185613a3d6p-22,
                                0x1.af38a9b0ec855p-26};

} // namespace

double exp(double x) {
    if (!(std::abs(x) < 746.0))
        return x > 0.0 ? inf : x < 0.0 ? 0.0 : nan;
    const double n = nearest_whole(x * std::numbers::log2e), high = x - n * ln2_high, low = n * ln2_low;
    const double r = high - low, rest = (high - r) - low;
    const double value = 1.0 + (r + (r * r * polynomial(exp_series, r) + rest));
    const auto twos = static_cast<std::int64_t>(n),
               most = twos / 2; // in two steps: 2^n alone may leave the range
    return value * power_of_two(most) * power_of_two(twos - most);
}

namespace {

/// (log((1 + s)/(1 - s)) - 2 s)/s^3 in s^2.
constexpr std::array log_series{0x1.5555555555555p-1, 0x1.9999999999a3ap-2, 0x1.2492492476765p-2,
                                0x1.c71c7201f207cp-3, 0x1.745cf8c4c7bcap-3, 0x1.3b1c42e3df02cp-3,
                                0x1.0fbd2bafa02d6p-3, 0x1.0c1263e1bac13p-3};

} // namespace

double log(double x) {
    if (!(x > 0.0 && x < inf))
        return x == 0.0 ? -inf : x > 0.0 ? inf : nan;
    // x = mantissa 2^twos with a mantissa in [sqrt(1/2), sqrt(2)).
    const bool subnormal = x < std::numeric_limits<double>::min();
    const auto bits = std::bit_cast<std::uint64_t>(subnormal ? x * 0x1p54 : x);
    constexpr std::uint64_t fraction = (std::uint64_t{1} << 52) - 1, one = std::uint64_t{1023} << 52;
    double mantissa = std::bit_cast<double>((bits & fraction) | one);
    int twos = static_cast<int>(bits >> 52) - 1023 - (subnormal ? 54 : 0);
    if (!(mantissa < std::numbers::sqrt2)) {
        mantissa *= 0.5;
        ++twos;
    }
    const double f = mantissa - 1.0, s = f / (2.0 + f), square = s * s, half = 0.5 * f * f;
    const double tail = s * (half + square * polynomial(log_series, square)) + twos * ln2_low;
    return twos * ln2_high - ((half - tail) - f); // 2 s = f - half + s half
}

namespace {

/// (atan(q) - q)/q^3 in q^2, |q| <= tan(pi/8).
constexpr std::array atan_series{-0x1.5555555555555p-2, 0x1.9999999999953p-3,  -0x1.249249248d7cap-3,
                                 0x1.c71c71c30300bp-4,  -0x1.745d165d9ee17p-4, 0x1.3b1392d04b71cp-4,
                                 -0x1.110e875de57ebp-4, 0x1.e19a0439b3b4bp-5,  -0x1.ac7a216389ddfp-5,
                                 0x1.74dbcb5c2167ap-5,  -0x1.1b2e7e3386b79p-5, 0x1.0ac7d2dc4c828p-6};
constexpr double tan_of_sixteenth = 0.41421356237309503; // of a turn

/// 0, pi/4, pi/2, 3 pi/4, pi.
constexpr std::array<Sum, 5> eighths{{{0.0, 0.0},
                                      {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
                                      {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},
                                      {0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54},
                                      {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53}}};

} // namespace

double atan2(double y, double x) {
    double less = std::abs(y), more = std::abs(x);
    const bool steep = less > more;
    if (steep)
        std::swap(less, more);
    const bool wide = less > tan_of_sixteenth * more;
    const double q = wide ? (less - more) / (less + more) : more == 0.0 ? 0.0 : less / more, square = q * q;
    const double rest = q * square * polynomial(atan_series, square);
    // eighths of a turn, plus or minus atan q
    std::size_t at = wide ? 1 : 0;
    double side = 1.0;
    if (steep) {
        at = 2 - at;
        side = -side;
    }
    if (std::signbit(x)) {
        at = 4 - at;
        side = -side;
    }
    return std::copysign(eighths[at].value + (side * q + (side * rest + eighths[at].rest)), y);
}

double asin(double x) { return atan2(x, std::sqrt((1.0 - x) * (1.0 + x))); }

} // namespace rodwake::repeatable
