// Passes of short transforms, a line a lane. Compiled once for each instruction set (foreach_target includes
// this file again); products and sums are rounded apart, so that bits are the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fft.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "nonuniform_fft.hpp"
#include "rodwake/core/error.hpp"
#include "vector_math_inl.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::fourier::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, Fft::lanes>;
using V = hn::Vec<Lanes>;

struct FftNumber {
    V re, im;
};

HWY_INLINE FftNumber Add(const FftNumber& a, const FftNumber& b) {
    return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE FftNumber Sub(const FftNumber& a, const FftNumber& b) {
    return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
HWY_INLINE FftNumber Scale(double factor, const FftNumber& a) {
    const V f = hn::Set(Lanes(), factor);
    return {hn::Mul(f, a.re), hn::Mul(f, a.im)};
}
HWY_INLINE FftNumber Turn(const Complex& w, const FftNumber& a) {
    const V re = hn::Set(Lanes(), w.re), im = hn::Set(Lanes(), w.im);
    return {hn::Sub(hn::Mul(re, a.re), hn::Mul(im, a.im)), hn::Add(hn::Mul(re, a.im), hn::Mul(im, a.re))};
}
/// -i a
HWY_INLINE FftNumber TurnedBack(const FftNumber& a) { return {a.im, hn::Neg(a.re)}; }

HWY_INLINE void ShortTransform(FftNumber (&x)[2]) {
    const FftNumber sum = Add(x[0], x[1]);
    x[1] = Sub(x[0], x[1]);
    x[0] = sum;
}

HWY_INLINE void ShortTransform(FftNumber (&x)[3]) {
    constexpr double sine = 0.86602540378443864676; // of 60 degrees
    const FftNumber sum = Add(x[1], x[2]), across = TurnedBack(Scale(sine, Sub(x[1], x[2])));
    const FftNumber middle = Sub(x[0], Scale(0.5, sum));
    x[0] = Add(x[0], sum);
    x[1] = Add(middle, across);
    x[2] = Sub(middle, across);
}

HWY_INLINE void ShortTransform(FftNumber (&x)[4]) {
    const FftNumber even = Add(x[0], x[2]), odd = Add(x[1], x[3]), d = Sub(x[0], x[2]),
                    across = TurnedBack(Sub(x[1], x[3]));
    x[0] = Add(even, odd);
    x[1] = Add(d, across);
    x[2] = Sub(even, odd);
    x[3] = Sub(d, across);
}

HWY_INLINE void ShortTransform(FftNumber (&x)[5]) {
    constexpr double c1 = 0.30901699437494742410, c2 = -0.80901699437494742410; // cos 72, 144
    constexpr double s1 = 0.95105651629515357212, s2 = 0.58778525229247312917;  // sin 72, 144
    const FftNumber p1 = Add(x[1], x[4]), m1 = Sub(x[1], x[4]), p2 = Add(x[2], x[3]), m2 = Sub(x[2], x[3]);
    const FftNumber a = Add(Add(x[0], Scale(c1, p1)), Scale(c2, p2)),
                    b = Add(Add(x[0], Scale(c2, p1)), Scale(c1, p2));
    const FftNumber u = TurnedBack(Add(Scale(s1, m1), Scale(s2, m2))),
                    v = TurnedBack(Sub(Scale(s2, m1), Scale(s1, m2)));
    x[0] = Add(Add(x[0], p1), p2);
    x[1] = Add(a, u);
    x[2] = Add(b, v);
    x[3] = Sub(b, v);
    x[4] = Sub(a, u);
}

/// One pass over sub-transforms of `length`, `stride` of them side by side.
template<std::size_t radix>
HWY_NOINLINE void Pass(std::size_t length, std::size_t stride, const Complex* turns, const Fft::Element* from,
                       Fft::Element* to) {
    const Lanes d;
    const std::size_t part = length / radix;
    for (std::size_t p = 0; p < part; ++p)
        for (std::size_t q = 0; q < stride; ++q)
            for (std::size_t lane = 0; lane < Fft::lanes; lane += hn::Lanes(d)) {
                FftNumber x[radix];
                RODWAKE_UNROLL
                for (std::size_t k = 0; k < radix; ++k) {
                    const Fft::Element& item = from[q + stride * (p + part * k)];
                    x[k] = {hn::LoadU(d, &item.re[lane]), hn::LoadU(d, &item.im[lane])};
                }
                ShortTransform(x);
                RODWAKE_UNROLL
                for (std::size_t k = 0; k < radix; ++k) {
                    if (k > 0)
                        x[k] = Turn(turns[k * p * stride], x[k]);
                    Fft::Element& each = to[q + stride * (radix * p + k)];
                    hn::StoreU(x[k].re, d, &each.re[lane]);
                    hn::StoreU(x[k].im, d, &each.im[lane]);
                }
            }
}

void RunPass(std::size_t radix, std::size_t length, std::size_t stride, const Complex* turns,
             const Fft::Element* from, Fft::Element* to) {
    const auto pass = radix == 2 ? Pass<2> : radix == 3 ? Pass<3> : radix == 4 ? Pass<4> : Pass<5>;
    pass(length, stride, turns, from, to);
}

} // namespace rodwake::fourier::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::fourier {

HWY_EXPORT(RunPass);

namespace {

/// What is left of `size` without its factors 2, 3 and 5.
std::size_t rest_of(std::size_t size) {
    for (const std::size_t prime : {2, 3, 5})
        while (size % prime == 0)
            size /= prime;
    return size;
}

} // namespace

Fft::Fft(std::size_t size) : size_(size) {
    if (size == 0 || rest_of(size) != 1)
        throw InputError(fmt::format("a transform of {} points: must be a product of 2, 3 and 5", size));
    for (const std::size_t radix : {4, 2, 3, 5})
        for (; size % radix == 0; size /= radix)
            radices_.push_back(radix);
    turns_.reserve(size_);
    for (std::size_t k = 0; k < size_; ++k) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(size_);
        turns_.push_back({std::cos(angle), -std::sin(angle)});
    }
}

void Fft::transform(std::vector<Element>& lines, std::vector<Element>& other) const {
    std::size_t length = size_, stride = 1;
    for (const std::size_t radix : radices_) {
        HWY_DYNAMIC_DISPATCH(RunPass)(radix, length, stride, turns_.data(), lines.data(), other.data());
        std::swap(lines, other);
        length /= radix;
        stride *= radix;
    }
}

std::size_t Fft::suitable(std::size_t least) {
    std::size_t size = least + least % 2;
    while (rest_of(size) != 1)
        size += 2;
    return size;
}

} // namespace rodwake::fourier
#endif
