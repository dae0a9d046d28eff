#pragma once
// Numbers with their derivatives by up to 9 variables, in extended precision: exact Jacobians for test
// models.

#include <array>
#include <cmath>
#include <cstddef>

struct Dual {
    static constexpr std::size_t variables = 9;
    long double value = 0.0L;
    std::array<long double, variables> slope{};

    Dual(long double v = 0.0L) : value(v) {}
    static Dual variable(long double v, std::size_t index) {
        Dual x(v);
        x.slope[index] = 1.0L;
        return x;
    }
    /// f(x) with f'(x) = derivative.
    Dual through(long double f, long double derivative) const {
        Dual y(f);
        for (std::size_t i = 0; i < variables; ++i)
            y.slope[i] = derivative * slope[i];
        return y;
    }
};

inline Dual operator+(const Dual& a, const Dual& b) {
    Dual y = a.through(a.value + b.value, 1.0L);
    for (std::size_t i = 0; i < Dual::variables; ++i)
        y.slope[i] += b.slope[i];
    return y;
}
inline Dual operator*(const Dual& a, const Dual& b) {
    Dual y = a.through(a.value * b.value, b.value);
    for (std::size_t i = 0; i < Dual::variables; ++i)
        y.slope[i] += a.value * b.slope[i];
    return y;
}
inline Dual operator-(const Dual& a) { return a.through(-a.value, -1.0L); }
inline Dual operator-(const Dual& a, const Dual& b) { return a + (-b); }
inline Dual reciprocal(const Dual& a) { return a.through(1.0L / a.value, -1.0L / (a.value * a.value)); }
inline Dual operator/(const Dual& a, const Dual& b) { return a * reciprocal(b); }
inline Dual exp(const Dual& a) { return a.through(std::exp(a.value), std::exp(a.value)); }
inline Dual log(const Dual& a) { return a.through(std::log(a.value), 1.0L / a.value); }
inline Dual sin(const Dual& a) { return a.through(std::sin(a.value), std::cos(a.value)); }
inline Dual cos(const Dual& a) { return a.through(std::cos(a.value), -std::sin(a.value)); }
inline Dual atan(const Dual& a) { return a.through(std::atan(a.value), 1.0L / (1.0L + a.value * a.value)); }
inline Dual pow(const Dual& a, const Dual& b) { return exp(b * log(a)); }
inline Dual square(const Dual& a) { return a * a; }
