// K0 and K1 from the rows of the kernels' tables, beside the accurate ones.

#include "elastic/bessel.hpp"
#include "rodwake/core/rng.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::elastic;

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
