// Elementary functions on vectors, compiled for each instruction set (include after foreach_target.h).
//
// Bits: every function is a fixed sequence of additions, products, fused products, divisions and square
// roots, each correctly rounded, so lanes do not know each other and every instruction set gives the same
// bits. Without fused products in hardware (x86 before 2013) they come from std::fma: the same bits, slowly;
// with RODWAKE_ROUND_PRODUCTS product and sum are rounded apart (WebAssembly, tools/explorer).
// Bracketed on paper: the compiler must not contract (RODWAKE_FLAGS).
//
// Functions take several vectors at a time and go through them operation by operation: one alone would wait
// for its own results most of the time.

#if defined(RODWAKE_ELASTIC_VECTOR_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_ELASTIC_VECTOR_MATH_INL
#undef RODWAKE_ELASTIC_VECTOR_MATH_INL
#else
#define RODWAKE_ELASTIC_VECTOR_MATH_INL
#endif

#include <cmath>
#include <hwy/highway.h>

// Left to itself the compiler keeps loops over a few vectors, and then those vectors in memory.
#undef RODWAKE_UNROLL
#define RODWAKE_UNROLL _Pragma("GCC unroll 16")

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// a b + c, rounded once (but see above).
template<class D, class V = hn::Vec<D>>
HWY_INLINE V Fma([[maybe_unused]] D d, V a, V b, V c) {
#if HWY_NATIVE_FMA || defined(RODWAKE_ROUND_PRODUCTS)
    return hn::MulAdd(a, b, c);
#else
    HWY_ALIGN hn::TFromD<D> x[hn::MaxLanes(D())], y[hn::MaxLanes(D())], z[hn::MaxLanes(D())];
    hn::Store(a, d, x);
    hn::Store(b, d, y);
    hn::Store(c, d, z);
    for (std::size_t k = 0; k < hn::MaxLanes(D()); ++k)
        z[k] = std::fma(x[k], y[k], z[k]);
    return hn::Load(d, z);
#endif
}

/// a b - c and c - a b, rounded once.
template<class D, class V = hn::Vec<D>>
HWY_INLINE V Fms([[maybe_unused]] D d, V a, V b, V c) {
#if HWY_NATIVE_FMA || defined(RODWAKE_ROUND_PRODUCTS)
    return hn::MulSub(a, b, c);
#else
    return Fma(d, a, b, hn::Neg(c));
#endif
}
template<class D, class V = hn::Vec<D>>
HWY_INLINE V Fnma([[maybe_unused]] D d, V a, V b, V c) {
#if HWY_NATIVE_FMA || defined(RODWAKE_ROUND_PRODUCTS)
    return hn::NegMulAdd(a, b, c);
#else
    return Fma(d, hn::Neg(a), b, c);
#endif
}

/// `yes` where v has its sign bit set. Highway's own looks beyond that bit where x86 cannot blend by it.
template<class D, class V = hn::Vec<D>>
HWY_INLINE V IfSigned([[maybe_unused]] D d, V v, V yes, V no) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSE4
    return hn::IfNegativeThenElse(v, yes, no);
#else
    const auto sign = hn::BroadcastSignBit(hn::BitCast(hn::RebindToSigned<D>(), v));
    return hn::IfThenElse(hn::RebindMask(d, hn::MaskFromVec(sign)), yes, no);
#endif
}

/// c[0] + c[1] x + ... of each of n vectors, even and odd powers apart: half the latency of one chain. Of the
/// first `used` coefficients, or of all.
template<std::size_t used = 0, std::size_t n, class D, std::size_t all, class V = hn::Vec<D>>
HWY_INLINE void Polynomials(D d, const V (&x)[n], const double (&c)[all], V (&result)[n]) {
    constexpr std::size_t terms = used == 0 ? all : used; // NOLINT(bugprone-branch-clone): may be equal
    static_assert(terms >= 4);
    const auto constant = [&](std::size_t k)
                              HWY_ATTR { return hn::Set(d, static_cast<hn::TFromD<D>>(c[k])); };
    constexpr std::size_t even = (terms - 1) / 2 * 2, odd = (terms - 2) / 2 * 2 + 1; // highest powers
    V square[n], evens[n], odds[n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        square[i] = hn::Mul(x[i], x[i]);
        evens[i] = constant(even);
        odds[i] = constant(odd);
    }
    RODWAKE_UNROLL
    for (std::size_t k = 2; k < terms; k += 2)
        RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        if (k <= even)
            evens[i] = Fma(d, evens[i], square[i], constant(even - k));
        if (k <= odd)
            odds[i] = Fma(d, odds[i], square[i], constant(odd - k));
    }
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i)
        result[i] = Fma(d, odds[i], x[i], evens[i]);
}

/// (e^r - 1 - r)/r^2 by powers of r, interpolated at Chebyshev points of |r| <= ln 2/2; r^2 times the error
/// is 2e-17, 2e-10 and 1e-8 of e^r with 10, 6 and 5 terms.
template<std::size_t terms>
inline constexpr double exponential_series[terms] = {};
template<>
inline constexpr double exponential_series<10>[] = {
    0.5000000000000001,    0.16666666666666669,    0.04166666666662413,   0.008333333333330062,
    0.0013888888917213717, 0.00019841269863053618, 2.4801521295954376e-5, 2.7557268459997064e-6,
    2.7620088445409746e-7, 2.510038549551032e-8};
template<>
inline constexpr double exponential_series<6>[] = {0.500000001346581,     0.16666666681623232,
                                                   0.041666464925285904,  0.0083333109254809,
                                                   0.0013933649996309251, 0.00019890990824673654};
template<>
inline constexpr double exponential_series<5>[] = {0.5, 0.16666576989698775, 0.041666554617204574,
                                                   0.008363179052722578, 0.0013926183587713494};

/// What e^-x needs to know of a precision.
template<class Real>
struct ExponentialConstants {
    static constexpr double largest = 708.0; ///< nears the smallest double
    static constexpr double round = 0x1.8p52, ln2_high = 0x1.62e42fefa39efp-1,
                            ln2_low = 0x1.abc9e3b39803fp-56;
};
template<>
struct ExponentialConstants<float> {
    static constexpr float largest = 40.0F; ///< products of two such are still normal: subnormals are slow
    static constexpr float round = 0x1.8p23F, ln2_high = 0x1.62e43p-1F, ln2_low = -0x1.05c611p-29F;
};

template<class D>
struct Exponential {
    hn::Vec<D> value;    ///< e^-x
    hn::Vec<D> less_one; ///< e^-x - 1
};

/// Of x >= 0. With all terms both to about an ulp; the value is 0 for x > `largest`, unless such x do not
/// occur.
template<std::size_t terms = 10, bool any_size = true, std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void ExpMinus(D d, const V (&x)[n], Exponential<D> (&result)[n]) {
    using Real = hn::TFromD<D>;
    using Constant = ExponentialConstants<Real>;
    const hn::RebindToUnsigned<D> bits;
    const V largest = hn::Set(d, Constant::largest), round = hn::Set(d, Constant::round),
            one = hn::Set(d, Real{1});
    V shifted[n], r[n], q[n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const V limited = any_size ? hn::Min(x[i], largest) : x[i];
        shifted[i] = Fma(d, limited, hn::Set(d, static_cast<Real>(-1.4426950408889634)), round);
        const V k =
            hn::Sub(shifted[i], round); // nearest integer to -x/ln 2; its bits are the last of `shifted`
        r[i] = Fms(d, k, hn::Set(d, -Constant::ln2_high), limited);
        r[i] = Fma(d, k, hn::Set(d, -Constant::ln2_low), r[i]);
    }
    Polynomials(d, r, exponential_series<terms>, q);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        const V p = Fma(d, hn::Mul(r[i], r[i]), q[i], r[i]);
        const auto exponent = hn::ShiftLeft<hwy::MantissaBits<Real>()>(hn::BitCast(bits, shifted[i]));
        const V power = hn::BitCast(d, hn::Add(hn::BitCast(bits, one), exponent));
        const V value = Fma(d, power, p, power);
        result[i].value = any_size ? hn::IfThenElseZero(hn::Le(x[i], largest), value) : value;
        result[i].less_one = Fma(d, power, p, hn::Sub(power, one));
    }
}

/// Taylor series of sin r/r and cos r by powers of r^2, |r| <= pi/4.
inline constexpr double sine_series[] = {
    1.0,          -1.0 / 6,         1.0 / 120,         -1.0 / 5040,
    1.0 / 362880, -1.0 / 39916800., 1.0 / 6227020800., -1.0 / 1307674368000.};
inline constexpr double cosine_series[] = {1.0,
                                           -1.0 / 2,
                                           1.0 / 24,
                                           -1.0 / 720,
                                           1.0 / 40320,
                                           -1.0 / 3628800.,
                                           1.0 / 479001600.,
                                           -1.0 / 87178291200.,
                                           1.0 / 20922789888000.};

template<class D>
struct SineCosine {
    hn::Vec<D> sine, cosine;
};

/// Of |x| < largest_angle: absolute error about an ulp of 1.
inline constexpr double largest_angle = 1e5;
template<std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void SinCos(D d, const V (&x)[n], SineCosine<D> (&result)[n]) {
    const hn::RebindToUnsigned<D> bits;
    const hn::RebindToSigned<D> integers;
    const V round = hn::Set(d, 0x1.8p52), sign = hn::SignBit(d);
    V shifted[n], r[n], square[n], s[n], c[n];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) {
        shifted[i] = Fma(d, x[i], hn::Set(d, 0.63661977236758134), round);
        const V k = hn::Sub(shifted[i], round);
        r[i] = Fma(d, k, hn::Set(d, -0x1.921fb54442d18p+0), x[i]);
        r[i] = Fma(d, k, hn::Set(d, -0x1.1a62633145c07p-54), r[i]);
        square[i] = hn::Mul(r[i], r[i]);
    }
    Polynomials(d, square, sine_series, s);
    Polynomials(d, square, cosine_series, c);
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < n; ++i) { // quadrants 0 1 2 3: sine s c -s -c, cosine c -s -c s
        const V sine = hn::Mul(r[i], s[i]);
        const auto quadrant = hn::BitCast(bits, shifted[i]);
        const auto odd = hn::ShiftLeft<63>(quadrant), half = hn::ShiftLeft<62>(quadrant);
        const auto swap =
            hn::RebindMask(d, hn::MaskFromVec(hn::BroadcastSignBit(hn::BitCast(integers, odd))));
        const V sine_sign = hn::And(hn::BitCast(d, half), sign);
        const V cosine_sign = hn::Xor(sine_sign, hn::And(hn::BitCast(d, odd), sign));
        result[i].sine = hn::Xor(hn::IfThenElse(swap, c[i], sine), sine_sign);
        result[i].cosine = hn::Xor(hn::IfThenElse(swap, sine, c[i]), cosine_sign);
    }
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
