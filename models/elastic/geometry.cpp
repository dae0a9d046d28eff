#include "geometry.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

/// (r + x)/(2 xi) to twice the precision. A power of two brings the larger coordinate near 1: exact, and safe
/// from overflow of the squares.
DoubleDouble precise_exponent(const Constants& medium, double x, double y) {
    const int exponent = std::ilogb(std::max(std::abs(x), std::abs(y)));
    const double x1 = std::ldexp(x, -exponent), y1 = std::ldexp(y, -exponent),
                 unit = std::ldexp(1.0, exponent);

    // r = sqrt(x1^2 + y1^2)
    const DoubleDouble xx = exact_product(x1, x1), yy = exact_product(y1, y1);
    const DoubleDouble sum = exact_sum(xx.high, yy.high);
    const double root = std::sqrt(sum.high);
    const double remainder = std::fma(-root, root, sum.high) + (sum.low + xx.low + yy.low);
    const DoubleDouble r = quick_sum(root, 0.5 * remainder / root);

    // r + x, behind the rod by y^2/(r - x)
    const DoubleDouble u = x1 >= 0.0 ? add(r, x1) : divide(yy, add(r, -x1));
    return divide({u.high * unit, u.low * unit}, {medium.two_xi, 0.0});
}

/// Below this an exponent rounded to double will do: its error, an ulp or two of itself, moves exp() by 8 ulp
/// at most.
constexpr double small_exponent = 8.0;

/// Beyond this exp() comes near the smallest double.
constexpr double huge_exponent = 500.0;

/// Beyond this it is 0, boosted or not, and its tail no longer matters.
constexpr double vanishing_exponent = 1e4;

} // namespace

Geometry::Geometry(const Constants& medium, double given_x, double given_y) : x(given_x), y(given_y) {
    X = x * medium.c_shear;
    Y = y * medium.c_shear;

    // s, 1/s and s +- |X|: one division for both quotients, since it and the square roots are what a point
    // costs most. Where the squares overflow or underflow it takes two; every illegal point ends up there.
    double far = 0.0, near = 0.0;
    if (const double square = X * X + Y * Y; square > 1e-190 && square < 1e280) {
        s = std::sqrt(square);
        far = s + std::abs(X);
        const double u = 1.0 / (s * far);
        inverse = far * u;
        near = Y * Y * (s * u);
    } else {
        s = std::hypot(X, Y);
        far = s + std::abs(X);
        if (!(s < 1e300))
            throw InputError(
                "the field is known at finite points only, r/xi < 1e300: got a coordinate that is not "
                "a number, infinite or beyond");
        if (s <= 0.5e-100)
            throw InputError(
                "the field is singular at the rod itself (r <= 1e-100 xi): move the point off the rod");
        inverse = 1.0 / s;
        near = Y * (Y / far);
    }
    root = std::sqrt(0.5 * std::numbers::pi * inverse);
    c = X * inverse;
    q = Y * inverse;
    const double both[] = {near, far}; // picked by index: a branch here would be taken at random
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
