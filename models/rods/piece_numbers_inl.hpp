// What pieces are computed with, a piece a lane: expansions in Chebyshev polynomials, and bounds of errors
// and of what maps them (include after foreach_target.h). docs/numerics.md, section 4.

#if defined(RODWAKE_RODS_PIECE_NUMBERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_RODS_PIECE_NUMBERS_INL
#undef RODWAKE_RODS_PIECE_NUMBERS_INL
#else
#define RODWAKE_RODS_PIECE_NUMBERS_INL
#endif

#include "step_polynomial.hpp"
#include "turning_bound_inl.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

/// Chebyshev coefficients from values at the nodes: of even order from sums of values at v and -v, the middle
/// last, of odd order from differences; and means of the polynomials.
struct ChebyshevRows {
    static constexpr std::size_t half = degree / 2;
    double even[half + 1][half + 1], odd[half][half], mean[half + 1];
    double integral[nodes][nodes]; ///< of the polynomial less its mean, from v = -1 to a node, by its values

    ChebyshevRows() {
        for (std::size_t i = 0; i <= half; ++i) {
            const double order = 2.0 * static_cast<double>(i);
            mean[i] = 1.0 / (1.0 - order * order);
            for (std::size_t j = 0; j <= half; ++j) {
                const double ends = (i == 0 || i == half ? 0.5 : 1.0) * (j == 0 ? 0.5 : 1.0);
                const double angle = std::numbers::pi * static_cast<double>(j) / degree;
                even[i][j] = 2.0 / degree * ends * std::cos(order * angle);
                if (i < half && j < half)
                    odd[i][j] = 2.0 / degree * (j == 0 ? 0.5 : 1.0) * std::cos((order + 1.0) * angle);
            }
        }
        for (std::size_t to = 0; to < nodes; ++to)
            for (std::size_t from = 0; from < nodes; ++from) {
                integral[to][from] = 0.0;
                for (std::size_t k = 1; k < nodes; ++k)
                    integral[to][from] += coefficient(k, from) * integral_of(k, node_at[to]);
            }
    }

    /// Of T_k in the polynomial that is 1 at this node and 0 at the others.
    double coefficient(std::size_t k, std::size_t node) const {
        const std::size_t j = std::min<std::size_t>(node, degree - node);
        if (k % 2 == 0)
            return even[k / 2][j];
        return j == half ? 0.0 : std::copysign(1.0, node_at[node]) * odd[k / 2][j];
    }
    /// int T_k - its mean, from -1 to v.
    static double integral_of(std::size_t k, double v) {
        const double n = static_cast<double>(k), angle = std::acos(v), sign = k % 2 == 0 ? 1.0 : -1.0;
        if (k == 1)
            return 0.5 * (v * v - 1.0);
        const double raw =
            0.5 * (std::cos((n + 1.0) * angle) / (n + 1.0) - std::cos((n - 1.0) * angle) / (n - 1.0));
        const double low = -0.5 * sign * (1.0 / (n + 1.0) - 1.0 / (n - 1.0));
        return raw - low - (k % 2 == 0 ? (v + 1.0) / (1.0 - n * n) : 0.0);
    }
};

/// Of a polynomial: its mean over a piece, and the sums of the sizes of its coefficients but the first, and
/// of those from the sixth order on.
struct Expanded {
    V mean, varies, tail;
};

HWY_INLINE Expanded ExpandedFrom(const V (&f)[nodes], const ChebyshevRows& rows) {
    const Lanes d;
    constexpr std::size_t half = ChebyshevRows::half;
    V sum[half + 1], difference[half];
    for (std::size_t j = 0; j < half; ++j) {
        sum[j] = hn::Add(f[degree - j], f[j]);
        difference[j] = hn::Sub(f[degree - j], f[j]);
    }
    sum[half] = f[half];
    Expanded e{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t i = 0; i <= half; ++i) {
        V c = hn::Mul(Number(rows.even[i][0]), sum[0]);
        RODWAKE_UNROLL
        for (std::size_t j = 1; j <= half; ++j)
            c = Fma(d, Number(rows.even[i][j]), sum[j], c);
        e.mean = Fma(d, Number(rows.mean[i]), c, e.mean);
        if (i > 0)
            e.varies = hn::Add(e.varies, hn::Abs(c));
        if (i > 2)
            e.tail = hn::Add(e.tail, hn::Abs(c));
    }
    for (std::size_t i = 0; i < half; ++i) {
        V c = hn::Mul(Number(rows.odd[i][0]), difference[0]);
        RODWAKE_UNROLL
        for (std::size_t j = 1; j < half; ++j)
            c = Fma(d, Number(rows.odd[i][j]), difference[j], c);
        e.varies = hn::Add(e.varies, hn::Abs(c));
        if (i > 2)
            e.tail = hn::Add(e.tail, hn::Abs(c));
    }
    return e;
}

/// Of places, heading 0 and heading 1: bounds of errors, and of what maps them. All numbers >= 0.
struct ErrorBounds {
    V of[3];
};
struct BoundMatrix {
    V of[3][3];
};

HWY_INLINE ErrorBounds Plus(const ErrorBounds& a, const ErrorBounds& b) {
    return {hn::Add(a.of[0], b.of[0]), hn::Add(a.of[1], b.of[1]), hn::Add(a.of[2], b.of[2])};
}
HWY_INLINE ErrorBounds Times(V c, const ErrorBounds& a) {
    return {hn::Mul(c, a.of[0]), hn::Mul(c, a.of[1]), hn::Mul(c, a.of[2])};
}
HWY_INLINE ErrorBounds Times(const BoundMatrix& a, const ErrorBounds& b) {
    const Lanes d;
    ErrorBounds product;
    for (std::size_t i = 0; i < 3; ++i)
        product.of[i] =
            Fma(d, a.of[i][0], b.of[0], Fma(d, a.of[i][1], b.of[1], hn::Mul(a.of[i][2], b.of[2])));
    return product;
}
HWY_INLINE BoundMatrix Times(const BoundMatrix& a, const BoundMatrix& b) {
    BoundMatrix product;
    for (std::size_t k = 0; k < 3; ++k) {
        const ErrorBounds column = Times(a, ErrorBounds{b.of[0][k], b.of[1][k], b.of[2][k]});
        for (std::size_t i = 0; i < 3; ++i)
            product.of[i][k] = column.of[i];
    }
    return product;
}
HWY_INLINE BoundMatrix Combined(const BoundMatrix& a, V c, const BoundMatrix& b) {
    BoundMatrix sum;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            sum.of[i][k] = Fma(Lanes(), c, b.of[i][k], a.of[i][k]);
    return sum;
}

/// 1/(1 - a). It is the sum of the powers of a if nothing in it is negative; `good` becomes false else.
HWY_INLINE BoundMatrix SumOfPowers(const BoundMatrix& a, M& good) {
    const Lanes d;
    V m[3][3];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            m[i][k] = hn::Sub(Number(i == k ? 1.0 : 0.0), a.of[i][k]);
    BoundMatrix inverse;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            inverse.of[k][i] = Fms(d, m[i1][k1], m[i2][k2], hn::Mul(m[i1][k2], m[i2][k1]));
        }
    const V determinant = Fma(d, m[0][0], inverse.of[0][0],
                              Fma(d, m[0][1], inverse.of[1][0], hn::Mul(m[0][2], inverse.of[2][0])));
    const V share = hn::Div(Number(1.0), determinant);
    for (auto& row : inverse.of)
        for (V& number : row) {
            number = hn::Mul(share, number);
            good = hn::And(good, hn::Ge(number, hn::Zero(d)));
        }
    return inverse;
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
