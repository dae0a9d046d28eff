// Points of non-uniform transforms on their grid. Compiled once for each instruction set (foreach_target
// includes this file again); sums have one order, so that bits are the same.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nonuniform_points.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "nonuniform_fft.hpp"
#include "vector_math_inl.hpp"

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace rodwake::fourier::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using elastic::HWY_NAMESPACE::Fma;

using Lanes = hn::CappedTag<double, 8>;

/// Some vectors of polynomials in u side by side; coefficient k of the first at c + k stride.
template<std::size_t vectors>
HWY_INLINE void PolynomialsOf(hn::Vec<Lanes> u, const double* c, std::size_t stride, std::size_t terms,
                              double* values) {
    const Lanes d;
    hn::Vec<Lanes> sum[vectors];
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < vectors; ++i)
        sum[i] = hn::LoadU(d, c + (terms - 1) * stride + i * hn::Lanes(d));
    for (std::size_t k = terms - 1; k-- > 0;)
        RODWAKE_UNROLL
    for (std::size_t i = 0; i < vectors; ++i)
        sum[i] = Fma(d, sum[i], u, hn::LoadU(d, c + k * stride + i * hn::Lanes(d)));
    RODWAKE_UNROLL
    for (std::size_t i = 0; i < vectors; ++i)
        hn::StoreU(sum[i], d, values + i * hn::Lanes(d));
}

/// `count` polynomials, whole vectors of them.
HWY_INLINE void PolynomialsAt(double at, const double* c, std::size_t stride, std::size_t terms,
                              std::size_t count, double* values) {
    const Lanes d;
    const auto u = hn::Set(d, at);
    std::size_t i = 0;
    for (; i + 3 * hn::Lanes(d) <= count; i += 3 * hn::Lanes(d))
        PolynomialsOf<3>(u, c + i, stride, terms, values + i);
    for (; i + 2 * hn::Lanes(d) <= count; i += 2 * hn::Lanes(d))
        PolynomialsOf<2>(u, c + i, stride, terms, values + i);
    for (; i < count; i += hn::Lanes(d))
        PolynomialsOf<1>(u, c + i, stride, terms, values + i);
}

struct Cover {
    std::uint32_t first;
    double u;
};

/// What a point covers, at `at` grid spacings.
HWY_INLINE Cover CoverOf(double at, const SpreadPlaces& positions) {
    const auto grid = static_cast<double>(positions.grid);
    const double wrapped = at - grid * std::floor(at / grid),
                 edge = wrapped - 0.5 * static_cast<double>(SpreadKernel::width), first = std::ceil(edge);
    const auto index = static_cast<std::uint32_t>(first < 0.0 ? first + grid : first);
    return {index % static_cast<std::uint32_t>(positions.grid), 2.0 * (first - edge) - 1.0};
}

void CoverPoints(const SpreadKernel& kernel, double per_length, std::span<const double> poses,
                 std::size_t first, std::size_t last, SpreadPlaces& positions) {
    for (std::size_t a = first; a < last; ++a) {
        const Cover row = CoverOf(poses[3 * a] * per_length, positions),
                    column = CoverOf(poses[3 * a + 1] * per_length, positions);
        positions.first_row[a] = row.first;
        positions.first_column[a] = column.first;
        PolynomialsAt(row.u, kernel.values(0), SpreadKernel::row, kernel.terms(), SpreadKernel::row,
                      &positions.x[a * SpreadKernel::row]);
        PolynomialsAt(column.u, kernel.twice(0), SpreadKernel::pairs, kernel.terms(), SpreadKernel::pairs,
                      &positions.y[a * SpreadKernel::pairs]);
    }
}

void SpreadPoint(const SpreadPlaces& positions, std::size_t point, Complex weight, std::size_t begin,
                 std::size_t end, std::size_t line, Complex* grid) {
    const Lanes d;
    const double *x = &positions.x[point * SpreadKernel::row], *y = &positions.y[point * SpreadKernel::pairs];
    std::size_t row = positions.first_row[point];
    for (std::size_t i = 0; i < SpreadKernel::width; ++i, row = row + 1 == positions.grid ? 0 : row + 1) {
        if (row < begin || row >= end)
            continue;
        const double re = x[i] * weight.re, im = x[i] * weight.im,
                     pairs[8] = {re, im, re, im, re, im, re, im};
        double* to = &grid[row * line + positions.first_column[point]].re;
        for (std::size_t j = 0; j < SpreadKernel::pairs; j += hn::Lanes(d))
            hn::StoreU(Fma(d, hn::LoadU(d, y + j), hn::LoadU(d, pairs + j % 8), hn::LoadU(d, to + j)), d,
                       to + j);
    }
}

Complex ReadPoint(const SpreadPlaces& positions, std::size_t point, std::size_t line, const Complex* grid) {
    const Lanes d;
    const double *x = &positions.x[point * SpreadKernel::row], *y = &positions.y[point * SpreadKernel::pairs];
    double sums[SpreadKernel::pairs] = {};
    for (std::size_t j = 0; j < SpreadKernel::pairs; j += hn::Lanes(d)) {
        auto sum = hn::Zero(d);
        std::size_t row = positions.first_row[point];
        for (std::size_t i = 0; i < SpreadKernel::width; ++i, row = row + 1 == positions.grid ? 0 : row + 1) {
            const double* from = &grid[row * line + positions.first_column[point]].re + j;
            sum = Fma(d, hn::Set(d, x[i]), hn::LoadU(d, from), sum);
        }
        hn::StoreU(hn::Mul(sum, hn::LoadU(d, y + j)), d, sums + j);
    }
    Complex all;
    for (std::size_t j = 0; j < SpreadKernel::width; ++j)
        all = all + Complex{sums[2 * j], sums[2 * j + 1]};
    return all;
}

} // namespace rodwake::fourier::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::fourier {

HWY_EXPORT(CoverPoints);
HWY_EXPORT(SpreadPoint);
HWY_EXPORT(ReadPoint);

void cover_points(const SpreadKernel& kernel, double per_length, std::span<const double> poses,
                  std::size_t first, std::size_t last, SpreadPlaces& positions) {
    HWY_DYNAMIC_DISPATCH(CoverPoints)(kernel, per_length, poses, first, last, positions);
}

void spread_point(const SpreadPlaces& positions, std::size_t point, Complex weight, std::size_t begin,
                  std::size_t end, std::size_t line, Complex* grid) {
    HWY_DYNAMIC_DISPATCH(SpreadPoint)(positions, point, weight, begin, end, line, grid);
}

Complex read_point(const SpreadPlaces& positions, std::size_t point, std::size_t line, const Complex* grid) {
    return HWY_DYNAMIC_DISPATCH(ReadPoint)(positions, point, line, grid);
}

} // namespace rodwake::fourier
#endif
