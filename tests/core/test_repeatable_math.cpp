// Elementary functions with repeatable bits: their errors against 50 digits, and their edges. Their bits:
// granular/test_fixed_bits.cpp.

#include "rodwake/core/repeatable_math.hpp"
#include "rodwake/core/rng.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace repeatable = rodwake::repeatable;

namespace {

using Exact = boost::multiprecision::cpp_bin_float_50;

/// In units of the last place of the exact value; where that is subnormal, of the smallest number.
double error_in_ulp(double value, const Exact& exact) {
    const double size = std::abs(static_cast<double>(exact));
    const int exponent = std::max(size > 0.0 ? std::ilogb(size) : -1074, -1022) - 52;
    return std::abs(static_cast<double>(boost::multiprecision::ldexp(Exact(value) - exact, -exponent)));
}

/// Both signs, sizes spread evenly on a logarithmic scale, by exact arithmetic.
std::vector<double> spread(int count, int lowest_power, int highest_power) {
    rodwake::RandomStream random(7);
    std::vector<double> numbers;
    for (int i = 0; i < count; ++i) {
        const int power = lowest_power + i % (highest_power - lowest_power);
        numbers.push_back(std::ldexp(1.0 + random.uniform(), power) * (i % 3 == 0 ? -1.0 : 1.0));
    }
    return numbers;
}

template<class Ours, class Theirs>
double worst(const std::vector<double>& at, const Ours& ours, const Theirs& theirs) {
    double most = 0.0;
    for (const double x : at)
        most = std::max(most, error_in_ulp(ours(x), theirs(Exact(x))));
    return most;
}

Exact sine(const Exact& x) { return sin(x); }
Exact cosine(const Exact& x) { return cos(x); }

} // namespace

TEST_CASE("sin and cos are right to 0.8 units of the last place up to 1e9 rad") {
    auto at = spread(6000, -40, 30);
    for (int i = 1; i < 3000; ++i) // nearest to their zeros, where the reduction has no digits to lose
        at.push_back(static_cast<double>(i * 37'171LL) * (std::numbers::pi / 2.0));
    at.insert(at.end(), {1e9, 5e8 + 0.1, std::nextafter(0x1p30, 0.0)});
    CHECK(worst(at, repeatable::sin, sine) < 0.8);
    CHECK(worst(at, repeatable::cos, cosine) < 0.8);
}

TEST_CASE("sin and cos beyond 2^30 rad are off by less than a step of the argument") {
    for (const double x : spread(300, 30, 60)) {
        const double step = std::nextafter(std::abs(x), 1e300) - std::abs(x);
        const auto [s, c] = repeatable::sin_cos(x);
        CHECK(std::abs(static_cast<double>(sine(Exact(x)) - s)) < 0.5 * step + 1e-15);
        CHECK(std::abs(static_cast<double>(cosine(Exact(x)) - c)) < 0.5 * step + 1e-15);
    }
}

TEST_CASE("exp and log are right to 0.8 and 0.7 units of the last place") {
    auto at = spread(3000, -40, 9);
    for (const double x : {709.7, -708.3, -720.0, -745.1}) // results near the ends of double
        at.push_back(x);
    CHECK(worst(at, repeatable::exp, [](const Exact& x) { return Exact(exp(x)); }) < 0.8);
    std::vector<double> positive;
    for (const double x : spread(4000, -1074, 1023))
        positive.push_back(std::abs(x));
    for (const double x : spread(3000, -50, -1))
        positive.push_back(1.0 + x);
    CHECK(worst(positive, repeatable::log, [](const Exact& x) { return Exact(log(x)); }) < 0.7);
}

TEST_CASE("atan2 is right to 1.6 units of the last place, asin to two") {
    const auto y = spread(6000, -30, 30), x = spread(5900, -29, 28);
    double most = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (const double scale : {1.0, y[i] / x[i]}) { // any direction; near those of equal sides
            const double across = y[i], along = x[i] * scale * (1.0 + 1e-3 * static_cast<double>(i % 1000));
            most = std::max(
                most, error_in_ulp(repeatable::atan2(across, along), atan2(Exact(across), Exact(along))));
        }
    CHECK(most < 1.6);
    std::vector<double> sines = spread(3000, -40, 0);
    std::erase_if(sines, [](double s) { return std::abs(s) > 1.0; });
    CHECK(worst(sines, repeatable::asin, [](const Exact& s) { return Exact(asin(s)); }) < 2.0);
}

TEST_CASE("edges of the elementary functions are those of the C library") {
    constexpr double inf = std::numeric_limits<double>::infinity();
    CHECK(std::isnan(repeatable::sin(inf)));
    CHECK(std::isnan(repeatable::cos(std::nan(""))));
    CHECK(repeatable::exp(0.0) == 1.0);
    CHECK(repeatable::exp(-inf) == 0.0);
    CHECK(repeatable::exp(710.0) == inf);
    CHECK(std::isnan(repeatable::exp(std::nan(""))));
    CHECK(repeatable::log(1.0) == 0.0);
    CHECK(repeatable::log(0.0) == -inf);
    CHECK(repeatable::log(inf) == inf);
    CHECK(std::isnan(repeatable::log(-1.0)));
    for (const double y : {0.0, -0.0, 1.0, -1.0})
        for (const double x : {0.0, -0.0, 1.0, -1.0}) {
            CHECK(repeatable::atan2(y, x) == std::atan2(y, x));
            CHECK(std::signbit(repeatable::atan2(y, x)) == std::signbit(std::atan2(y, x)));
        }
    CHECK(repeatable::asin(-1.0) == std::asin(-1.0));
}
