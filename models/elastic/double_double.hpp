#pragma once
// Numbers of twice the precision, where rounding to double would cost digits of the result. Building blocks
// of Dekker and Knuth; see Hida, Li, Bailey (2001), "Library for double-double and quad-double arithmetic".

#include <cmath>

namespace rodwake::elastic {

/// Unevaluated sum high + low, |low| <= ulp(high)/2.
struct DoubleDouble {
    double high, low;
};

inline DoubleDouble quick_sum(double a, double b) { // |a| >= |b|
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

inline DoubleDouble exact_sum(double a, double b) {
    const double sum = a + b, virtual_b = sum - a;
    return {sum, (a - (sum - virtual_b)) + (b - virtual_b)};
}

inline DoubleDouble exact_product(double a, double b) {
    const double product = a * b;
    return {product, std::fma(a, b, -product)};
}

inline DoubleDouble add(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble high = exact_sum(a.high, b.high), low = exact_sum(a.low, b.low);
    const DoubleDouble sum = quick_sum(high.high, high.low + low.high);
    return quick_sum(sum.high, sum.low + low.low);
}

inline DoubleDouble add(DoubleDouble a, double b) {
    const DoubleDouble sum = exact_sum(a.high, b);
    return quick_sum(sum.high, sum.low + a.low);
}

inline DoubleDouble multiply(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble product = exact_product(a.high, b.high);
    return quick_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

inline DoubleDouble divide(DoubleDouble a, DoubleDouble b) {
    const double quotient = a.high / b.high;
    const DoubleDouble back = exact_product(quotient, b.high);
    const double remainder = ((a.high - back.high) - back.low) + a.low - quotient * b.low;
    return quick_sum(quotient, remainder / b.high);
}

} // namespace rodwake::elastic
