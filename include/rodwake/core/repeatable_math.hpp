#pragma once
// Elementary functions whose bits are the same on every machine, for what changes a state. Those of the C
// library differ between libraries, and in glibc with the processor. These use + - * / and sqrt of IEEE 754
// only, no fused products (-ffp-contract=off), rounding to nearest. Errors are the largest that
// tests/core/test_repeatable_math.cpp finds against 50 digits, in units of the last place (ulp).

#include <cmath>

namespace rodwake::repeatable {

struct SinCos {
    double sin, cos;
};

/// 0.8 ulp for |x| < 2^30 rad. Beyond, x is first taken modulo the double next to 2 pi, which moves it by
/// less than half the distance between doubles there. Not finite: NaN.
SinCos sin_cos(double x);
inline double sin(double x) { return sin_cos(x).sin; }
inline double cos(double x) { return sin_cos(x).cos; }

/// 0.8 ulp; 0 below -745.2 and infinite above 709.8.
double exp(double x);

/// 0.7 ulp; -infinity at 0, NaN below.
double log(double x);

/// In [-pi, pi], zeros as in the C library; 1.6 ulp. |x| and |y| below 1e300; quotients that underflow are 0.
double atan2(double y, double x);

/// -1 <= x <= 1; 2 ulp.
double asin(double x);

/// sqrt(x^2 + y^2) with neither square beyond the range of double: 1 ulp.
inline double length(double x, double y) { return std::sqrt(x * x + y * y); }

} // namespace rodwake::repeatable
