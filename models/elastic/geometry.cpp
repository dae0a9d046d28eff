#include "geometry.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

/// r = sqrt(x^2 + y^2) for operands whose squares neither overflow nor lose bits that matter.
DoubleDouble distance(double x, double y) {
    const DoubleDouble xx = exact_product(x, x), yy = exact_product(y, y);
    const DoubleDouble sum = exact_sum(xx.high, yy.high);
    const double r = std::sqrt(sum.high);
    const double remainder = std::fma(-r, r, sum.high) + (sum.low + xx.low + yy.low);
    return quick_sum(r, 0.5 * remainder / r);
}

/// r + x, by y^2/(r - x) behind the rod.
DoubleDouble distance_plus_x(DoubleDouble r, double x, double y) {
    if (x >= 0.0)
        return add(r, x);
    return divide(exact_product(y, y), add(r, -x));
}

/// (r + x)/(2 xi) to twice the precision. A power of two brings the larger coordinate near 1: exact, and safe
/// from overflow of the squares.
DoubleDouble precise_exponent(const Constants& medium, double x, double y) {
    const int exponent = std::ilogb(std::max(std::abs(x), std::abs(y)));
    const double x1 = std::ldexp(x, -exponent), y1 = std::ldexp(y, -exponent),
                 unit = std::ldexp(1.0, exponent);
    const DoubleDouble u = distance_plus_x(distance(x1, y1), x1, y1);
    return divide({u.high * unit, u.low * unit}, {medium.two_xi, 0.0});
}

/// Below this an exponent rounded to double will do: its error, an ulp or two of itself, moves exp() by 8 ulp
/// at most.
constexpr double small_exponent = 8.0;

/// Beyond this exp() comes near the smallest double.
constexpr double huge_exponent = 500.0;

/// Beyond this it is 0, boosted or not, and its tail no longer matters.
constexpr double vanishing_exponent = 1e4;

/// s and its parts where the squares of the coordinates overflow or underflow; every illegal point ends up
/// here.
struct Distances {
    double s, inverse; ///< 1/s
    double far, near;  ///< s + |X|, s - |X|
};

Distances extreme_distances(double X, double Y) {
    const double s = std::hypot(X, Y), far = s + std::abs(X);
    if (!(s < 1e300))
        throw InputError(
            "the field is known at finite points only, r/xi < 1e300: got a coordinate that is not "
            "a number, infinite or beyond");
    if (s <= 0.5e-100)
        throw InputError(
            "the field is singular at the rod itself (r <= 1e-100 xi): move the point off the rod");
    return {s, 1.0 / s, far, Y * (Y / far)};
}

/// One division for both quotients: it and the square roots are what a point costs most.
Distances distances(double X, double Y) {
    const double square = X * X + Y * Y;
    if (!(square > 1e-190 && square < 1e280))
        return extreme_distances(X, Y);
    const double s = std::sqrt(square), far = s + std::abs(X), u = 1.0 / (s * far);
    return {s, far * u, far, Y * Y * (s * u)};
}

} // namespace

Geometry::Geometry(const Constants& medium, double given_x, double given_y) : x(given_x), y(given_y) {
    X = x * medium.c_shear;
    Y = y * medium.c_shear;
    const Distances d = distances(X, Y);
    s = d.s;
    inverse = d.inverse;
    root = std::sqrt(0.5 * std::numbers::pi * inverse);
    c = X * inverse;
    q = Y * inverse;
    const double both[] = {d.near, d.far}; // picked by index: a branch here would be taken at random
    const bool ahead = X >= 0.0;
    w = {both[ahead], 0.0};
    p = both[ahead] * inverse;
    n = both[!ahead] * inverse;
    const double fastest = w.high * std::max(1.0, medium.nu), slowest = w.high * std::min(1.0, medium.nu);
    boost = fastest > huge_exponent ? 0x1p200 : 1.0;
    if (fastest > small_exponent && slowest < vanishing_exponent)
        w = precise_exponent(medium, x, y);
}

DoubleDouble times(DoubleDouble a, DoubleDouble b) {
    const double plain = a.high * b.high;
    if (plain < small_exponent || plain > vanishing_exponent)
        return {std::min(plain, vanishing_exponent), 0.0};
    return multiply(a, b);
}

double exp_minus(DoubleDouble exponent, double boost) {
    if (exponent.high < huge_exponent)
        return boost * std::exp(-exponent.high) * (1.0 - exponent.low);
    const double half = std::exp(-0.5 * exponent.high);
    return half * boost * half * (1.0 - exponent.low);
}

Vector turned(const Vector& v, double cosine, double sine) {
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
}

SymmetricTensor turned(const SymmetricTensor& t, double cosine, double sine) {
    const double cc = cosine * cosine, ss = sine * sine, cs = cosine * sine;
    return {cc * t.xx - 2.0 * cs * t.xy + ss * t.yy, cs * (t.xx - t.yy) + (cc - ss) * t.xy,
            ss * t.xx + 2.0 * cs * t.xy + cc * t.yy};
}

PrincipalAxis extensional_axis(const SymmetricTensor& tensor) {
    const double half_difference = 0.5 * (tensor.xx - tensor.yy) + 0.0,
                 xy = tensor.xy + 0.0; // -0 is 0 to atan2
    return {std::hypot(half_difference, xy), 0.5 * std::atan2(xy, half_difference)};
}

} // namespace rodwake::elastic
