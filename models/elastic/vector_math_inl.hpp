// Elementary functions on vectors, compiled for each instruction set (include after foreach_target.h).
//
// Bits: every function is a fixed sequence of additions, products, fused products, divisions and square
// roots, each correctly rounded, so lanes do not know each other and every instruction set gives the same
// bits. Without fused products in hardware (x86 before 2013) they come from std::fma: the same bits, slowly.
// Bracketed on paper: the compiler must not contract (RODWAKE_FLAGS).

#if defined(RODWAKE_ELASTIC_VECTOR_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_ELASTIC_VECTOR_MATH_INL
#undef RODWAKE_ELASTIC_VECTOR_MATH_INL
#else
#define RODWAKE_ELASTIC_VECTOR_MATH_INL
#endif

#include <cmath>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rodwake::elastic::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// a b + c, rounded once.
template<class D, class V = hn::Vec<D>>
HWY_INLINE V Fma([[maybe_unused]] D d, V a, V b, V c) {
#if HWY_NATIVE_FMA
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

/// c[0] + c[1] x + ... for all lanes, even and odd powers apart: half the latency of one chain.
template<class D, std::size_t terms, class V = hn::Vec<D>>
HWY_INLINE V Polynomial(D d, V x, const double (&c)[terms]) {
    static_assert(terms >= 4);
    const auto constant = [&](std::size_t k)
                              HWY_ATTR { return hn::Set(d, static_cast<hn::TFromD<D>>(c[k])); };
    const V square = hn::Mul(x, x);
    V sum = constant(terms - 1), other = constant(terms - 2);
    for (std::size_t k = terms - 2; k-- > 0;) {
        const V next = Fma(d, sum, square, constant(k));
        sum = other;
        other = next;
    } // `other` ends at power 0, `sum` at power 1
    return Fma(d, sum, x, other);
}

/// 1/2!, 1/3!, ...: of (e^r - 1 - r)/r^2. |r| <= ln 2/2: the next term is 4e-18 of e^r.
inline constexpr double exponential_series[] = {
    1.0 / 2,     1.0 / 6,      1.0 / 24,       1.0 / 120,       1.0 / 720,        1.0 / 5040,
    1.0 / 40320, 1.0 / 362880, 1.0 / 3628800., 1.0 / 39916800., 1.0 / 479001600., 1.0 / 6227020800.};

template<class D>
struct Exponential {
    hn::Vec<D> value;    ///< e^-x
    hn::Vec<D> less_one; ///< e^-x - 1
};

/// Of x >= 0. Both to about an ulp; the value is 0 for x > 708, where it nears the smallest double.
template<class D, class V = hn::Vec<D>>
HWY_INLINE Exponential<D> ExpMinus(D d, V x) {
    const hn::RebindToUnsigned<D> bits;
    const V largest = hn::Set(d, 708.0), round = hn::Set(d, 0x1.8p52);
    const V shifted = Fma(d, hn::Min(x, largest), hn::Set(d, -1.4426950408889634), round);
    const V k = hn::Sub(shifted, round); // nearest integer to -x/ln 2; its bits are the last of `shifted`
    V r = Fma(d, k, hn::Set(d, -0x1.62e42fefa39efp-1), hn::Neg(hn::Min(x, largest)));
    r = Fma(d, k, hn::Set(d, -0x1.abc9e3b39803fp-56), r);
    const V p = Fma(d, hn::Mul(r, r), Polynomial(d, r, exponential_series), r);
    const V one = hn::Set(d, 1.0);
    const V power =
        hn::BitCast(d, hn::Add(hn::BitCast(bits, one), hn::ShiftLeft<52>(hn::BitCast(bits, shifted))));
    const V value = Fma(d, power, p, power);
    return {hn::IfThenElseZero(hn::Le(x, largest), value), Fma(d, power, p, hn::Sub(power, one))};
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
template<class D, class V = hn::Vec<D>>
HWY_INLINE SineCosine<D> SinCos(D d, V x) {
    const hn::RebindToUnsigned<D> bits;
    const V round = hn::Set(d, 0x1.8p52);
    const V shifted = Fma(d, x, hn::Set(d, 0.63661977236758134), round);
    const V k = hn::Sub(shifted, round);
    V r = Fma(d, k, hn::Set(d, -0x1.921fb54442d18p+0), x);
    r = Fma(d, k, hn::Set(d, -0x1.1a62633145c07p-54), r);
    const V square = hn::Mul(r, r);
    const V s = hn::Mul(r, Polynomial(d, square, sine_series)), c = Polynomial(d, square, cosine_series);
    const auto quadrant = hn::BitCast(bits, shifted);
    const auto odd = hn::ShiftLeft<63>(quadrant), half = hn::ShiftLeft<62>(quadrant);
    const auto sign = hn::SignBit(d);
    // quadrants 0 1 2 3: sine s c -s -c, cosine c -s -c s
    const auto swap = hn::MaskFromVec(hn::BroadcastSignBit(hn::BitCast(hn::RebindToSigned<D>(), odd)));
    const auto swapped = hn::RebindMask(d, swap);
    const V sine_sign = hn::And(hn::BitCast(d, half), sign);
    const V cosine_sign = hn::Xor(sine_sign, hn::And(hn::BitCast(d, odd), sign));
    return {hn::Xor(hn::IfThenElse(swapped, c, s), sine_sign),
            hn::Xor(hn::IfThenElse(swapped, s, c), cosine_sign)};
}

} // namespace rodwake::elastic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
