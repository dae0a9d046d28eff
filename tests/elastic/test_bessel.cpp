// The Bessel functions in every binade, beside their oracle, in units in the last place.

#include "multiprecision.hpp"

#include "elastic/bessel.hpp"
#include "rodwake/core/rng.hpp"

#include <boost/math/constants/constants.hpp>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

using namespace rodwake;
using namespace rodwake::oracle;
using namespace rodwake::elastic;

namespace {

double ulps(double got, const Real& exact) {
    const double nearest = std::abs(static_cast<double>(exact));
    const double spacing = std::nextafter(nearest, INFINITY) - nearest;
    return std::abs(static_cast<double>((got - exact) / spacing));
}

/// Exact values in the order of elastic::Bessel. Beyond 1e60 d2 would cancel 120 of the digits: there the
/// leading term is exact to 60.
struct Exact {
    Real k0, k1, d1, d2;
};
Exact exact_scaled(const Real& z) {
    if (z > 1e60) {
        const Real k = sqrt(boost::math::constants::half_pi<Real>() / z);
        return {k, k, k / (2 * z), 3 * k / (4 * z * z)};
    }
    const auto [k0, k1] = scaled_bessel(z);
    return {k0, k1, k1 - k0, k1 / z - 2 * (k1 - k0)};
}

struct WorstUlps {
    double k0 = 0, k1 = 0, d1 = 0, d2 = 0, kappa1 = 0;
    void include(const elastic::Bessel& got, const Exact& exact) {
        k0 = std::max(k0, ulps(got.k0, exact.k0));
        k1 = std::max(k1, ulps(got.k1, exact.k1));
        d1 = std::max(d1, ulps(got.d1, exact.d1));
        if (exact.d2 > 1e-300) // else it underflows
            d2 = std::max(d2, ulps(got.d2, exact.d2));
    }
};

/// From the double 1/z and the double root of it, as if both were exact.
void add_scaled(WorstUlps& worst, double z) {
    const double t = 1.0 / z;
    const Real root = sqrt(boost::math::constants::half_pi<Real>() * t);
    worst.include(elastic::scaled_bessel(t, static_cast<double>(root)), exact_scaled(1 / Real(t)));
}

void add_plain(WorstUlps& worst, double z) {
    const Real e = exp(Real(-z));
    const Exact s = exact_scaled(z);
    worst.include(elastic::plain_bessel(z), {e * s.k0, e * s.k1, e * s.d1, e * s.d2});
}

void add_core(WorstUlps& worst, double z) {
    const Exact s = exact_scaled(z);
    const double log_half = std::log(0.5 * z);
    const elastic::CoreBessel k =
        elastic::core_bessel(elastic::Pair{0.1, z}, elastic::Pair{std::log(0.05), log_half});
    const Real e = exp(Real(-z));
    worst.k0 = std::max(worst.k0, ulps(k.k0[1], e * s.k0));
    // K1 - 1/z would cancel z^2 of its parts; the next term of its series is z^2 log z smaller than the
    // first.
    const Real leading =
        Real(z) / 2 * (log(Real(z) / 2) + boost::math::constants::euler<Real>() - Real(1) / 2);
    worst.kappa1 = std::max(worst.kappa1, ulps(k.kappa1[1], z < 1e-30 ? leading : e * s.k1 - 1 / Real(z)));
}

/// Points in each binade of [2^low, 2^high), within (from, to].
template<class Visit>
void each_binade(int low, int high, int points, double from, double to, Visit visit) {
    RandomStream random(71);
    for (int binade = low; binade < high; ++binade)
        for (int k = 0; k < points; ++k) {
            const double z = std::ldexp(random.uniform(1.0, 2.0), binade);
            if (z > from && z <= to)
                visit(z);
        }
}

template<class Visit>
void around(double z, double from, double to, Visit visit) {
    for (int k = 0; k < 4; ++k)
        z = std::nextafter(z, 0.0);
    for (int k = -4; k <= 4; ++k, z = std::nextafter(z, INFINITY))
        if (z > from && z <= to)
            visit(z);
}

constexpr int lowest = -996, highest = 996; // 1e-300 .. 1e300

WorstUlps scaled_worst(int points) {
    WorstUlps worst;
    const auto visit = [&](double z) { add_scaled(worst, z); };
    each_binade(-1, highest, points, elastic::series_end, INFINITY, visit);
    for (double octave = 0.0625; octave <= 2.0; octave *= 2.0) { // edges of the fitted pieces
        around(1.0 / octave, elastic::series_end, INFINITY, visit);
        around(1.0 / (1.5 * octave), elastic::series_end, INFINITY, visit);
    }
    return worst;
}

void check_scaled(const WorstUlps& worst) {
    CAPTURE(worst.k0, worst.k1, worst.d1, worst.d2);
    CHECK(worst.k0 <= 4.0); // the header's claims
    CHECK(worst.k1 <= 4.0);
    CHECK(worst.d1 <= 4.0);
    CHECK(worst.d2 <= 6.0);
}

} // namespace

TEST_CASE("scaled Bessel functions in every binade and around every edge") { check_scaled(scaled_worst(3)); }

TEST_CASE("scaled Bessel functions, many points", "[.][long]") {
    const WorstUlps worst = scaled_worst(400);
    std::printf("scaled: k0 %.2f, k1 %.2f, d1 %.2f, d2 %.2f ulp\n", worst.k0, worst.k1, worst.d1, worst.d2);
    check_scaled(worst);
}

TEST_CASE("plain Bessel functions down to z = 1e-120") {
    WorstUlps worst;
    const auto visit = [&](double z) { add_plain(worst, z); };
    each_binade(-399, 0, 1, 0.0, elastic::series_end, visit);
    each_binade(-8, 0, 15, 0.0, elastic::series_end, visit);
    around(elastic::series_end, 0.0, elastic::series_end, visit);
    CAPTURE(worst.k0, worst.k1, worst.d1, worst.d2);
    CHECK(worst.k0 <= 3.0); // the header's claims
    CHECK(worst.k1 <= 3.0);
    CHECK(worst.d1 <= 6.0);
    CHECK(worst.d2 <= 6.0);
}

TEST_CASE("core Bessel functions in every binade") {
    WorstUlps worst;
    const auto visit = [&](double z) { add_core(worst, z); };
    each_binade(lowest, 0, 1, 0.0, elastic::series_end, visit);
    each_binade(-8, 0, 15, 0.0, elastic::series_end, visit);
    around(elastic::series_end, 0.0, elastic::series_end, visit);
    CAPTURE(worst.k0, worst.kappa1);
    CHECK(worst.k0 <= 3.0); // the header's claims
    CHECK(worst.kappa1 <= 4.0);
}

namespace {

/// Largest and mean error of the kernels' K0 and K1 in one binade.
struct BinadeUlps {
    double largest[2] = {}, mean[2] = {};
};

BinadeUlps table_ulps(int binade, int points) {
    RandomStream random(73 + static_cast<std::uint64_t>(binade - elastic::lowest_binade));
    std::vector<double> z(points), k[2] = {z, z};
    for (double& one : z)
        one = std::ldexp(random.uniform(1.0, 2.0), binade);
    z[0] = std::ldexp(1.0, binade);
    z[1] = std::nextafter(std::ldexp(2.0, binade), 0.0);
    elastic::table_bessel(z, k[0], k[1]);
    BinadeUlps found;
    for (int i = 0; i < points; ++i) {
        const auto [k0, k1] = scaled_bessel(Real(z[i]));
        for (int q = 0; q < 2; ++q) {
            const double error = ulps(k[q][i], q == 0 ? k0 : k1);
            found.largest[q] = std::max(found.largest[q], error);
            found.mean[q] += error / points;
        }
    }
    return found;
}

} // namespace

TEST_CASE("the kernels' K0 and K1 in every binade of their table") {
    constexpr int binades = elastic::end_binade - elastic::lowest_binade;
    double mean[2] = {};
    for (int binade = elastic::lowest_binade; binade < elastic::end_binade; ++binade) {
        const BinadeUlps found = table_ulps(binade, 6);
        CAPTURE(binade, found.largest[0], found.largest[1]);
        for (int q = 0; q < 2; ++q) {
            CHECK(found.largest[q] <= 2.0); // bessel_table.hpp
            mean[q] += found.mean[q] / binades;
        }
    }
    CAPTURE(mean[0], mean[1]);
    CHECK(mean[0] <= 0.6);
    CHECK(mean[1] <= 0.6);
    CHECK(mean[0] > 0.25); // of exact values rounded once: else nothing was compared
}

TEST_CASE("the kernels' K0 and K1, many points", "[.][long]") {
    for (int binade = elastic::lowest_binade; binade < elastic::end_binade; ++binade) {
        const BinadeUlps found = table_ulps(binade, 2000);
        std::printf("2^%d: K0 %.2f, mean %.2f; K1 %.2f, mean %.2f ulp\n", binade, found.largest[0],
                    found.mean[0], found.largest[1], found.mean[1]);
        for (int q = 0; q < 2; ++q) {
            CHECK(found.largest[q] <= 2.0);
            CHECK(found.mean[q] <= 0.6);
        }
    }
}

TEST_CASE("a count of ulps can fail") {
    CHECK(ulps(1.0, 1) == 0.0);
    CHECK(ulps(std::nextafter(1.0, 2.0), 1) == 1.0);
    CHECK(ulps(1.0 + 0x1p-46, 1) == 64.0);
    WorstUlps worst;
    worst.include({1.0, 2.0, 1.0, 0.5}, {1, 2, 1, Real(0.5) + Real(0x1p-40)});
    CHECK(worst.k0 == 0.0);
    CHECK(worst.d2 > 1e3);
}

// --- K0 and K1 from the rows of the kernels' tables, beside the accurate ones

namespace {

struct Scaled {
    double k0, k1;
};

/// As the header says, one coefficient after the other.
template<class Real>
Scaled from_table(const BesselTable<Real>& table, TableShape shape, double z) {
    int exponent = 0;
    const double m = 2.0 * std::frexp(z, &exponent);
    const int binade = exponent - 1, pieces = 1 << shape.piece_bits;
    const int i = static_cast<int>((m - 1.0) * pieces);
    const Real* row = table.rows() + ((binade - lowest_binade) * pieces + i) * shape.stride();
    const double middle = 1.0 + (2.0 * i + 1.0) / (2.0 * pieces), t = (m - middle) / m;
    double p = 0.0, derivative = 0.0;
    for (int k = shape.terms - 1; k >= 0; --k) {
        derivative = derivative * t + p;
        p = p * t + row[k];
    }
    const bool low = z < 1.0;
    const double k0 = low ? p + std::log1p(-t) : p;
    return {k0, k0 + ((low ? 1.0 : 0.0) - (1.0 - t) * derivative) / z};
}

Scaled accurate(double z) {
    if (z > series_end) {
        const Bessel k = scaled_bessel(1.0 / z, std::sqrt(0.5 * std::numbers::pi / z));
        return {k.k0, k.k1};
    }
    const Bessel k = plain_bessel(z);
    return {std::exp(z) * k.k0, std::exp(z) * k.k1};
}

template<class Real>
double worst_error(const BesselTable<Real>& table, TableShape shape) {
    RandomStream random(91);
    double worst = 0.0;
    for (int binade = lowest_binade; binade < end_binade; ++binade)
        for (int k = 0; k < 100; ++k) {
            const double z = std::ldexp(random.uniform(1.0, 2.0), binade);
            const Scaled got = from_table(table, shape, z), exact = accurate(z);
            worst = std::max({worst, std::abs(got.k0 / exact.k0 - 1.0), std::abs(got.k1 / exact.k1 - 1.0)});
        }
    return worst;
}

} // namespace

TEST_CASE("the table holds K0 and K1 to their last digits in every binade") {
    CHECK(worst_error(bessel_table(), full_shape) <
          6e-15); // of K1 just above a power of two; 4 ulp are the reference's
}

TEST_CASE("tables of fewer terms are as coarse as they should be") {
    for (const auto& [shape, low, high] :
         {std::tuple{TableShape{4, 6}, 1e-11, 2e-9}, {TableShape{4, 4}, 1e-7, 1e-5}}) {
        const double error = worst_error(make_bessel_table<double>(shape), shape);
        CAPTURE(shape.terms);
        CHECK(error > low);
        CHECK(error < high);
    }
}

TEST_CASE("a wrong coefficient is seen") {
    for (const int k : {0, 1, 5}) {
        BesselTable<double> table = bessel_table();
        for (std::size_t row = 0; row < table.coefficients.size(); row += full_shape.terms)
            table.coefficients[row + k] += 1e-5;
        CAPTURE(k);
        CHECK(worst_error(table, full_shape) > 1e-13);
    }
}
