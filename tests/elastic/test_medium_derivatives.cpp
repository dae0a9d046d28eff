// Derivatives of the field by eta and xi against central differences of the oracle: step 1e-20 of xi or 1 +
// eta in 220 digits, so 1e-40 of truncation and 20 digits or more left by rounding.

#include "error_norm.hpp"
#include "sample.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/elastic/medium_derivatives.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

using namespace rodwake;
using namespace rodwake::oracle;

namespace {

constexpr elastic::FieldRequest plain{true, true, true, true, false};

enum class By { eta, xi };

struct Exact {
    oracle::Field high, low;
    Real step;
};

Exact exact(const Point& p, By by) {
    const Real xi(p.xi), eta(p.eta), tiny = ldexp(Real(1), -66);
    if (by == By::eta) {
        const Real h = tiny * (1 + eta);
        return {oracle::Field(p.x, p.y, {xi, eta + h}), oracle::Field(p.x, p.y, {xi, eta - h}), h};
    }
    const Real h = tiny * xi;
    return {oracle::Field(p.x, p.y, {xi + h, eta}), oracle::Field(p.x, p.y, {xi - h, eta}), h};
}

std::vector<Real> quotient(const Exact& e, Quantity q) {
    std::vector<Real> slope = components(e.high, q);
    const std::vector<Real> low = components(e.low, q);
    for (std::size_t k = 0; k < slope.size(); ++k)
        slope[k] = (slope[k] - low[k]) / (2 * e.step);
    return slope;
}

/// What the header allows there, in units of its plain bound.
double allowance(const Point& p, By by, Quantity q) {
    const double nu = 1.0 / (1.0 + p.eta), delta = std::abs(p.eta) * nu;
    if (q == Quantity::laplacian || q == Quantity::gradient_of_trace)
        return 1.0 + 1e-4 * nu * std::hypot(p.x, p.y) / p.xi;
    return by == By::xi && q == Quantity::dipole && delta > 0.0 ? std::max(1.0, 1e-3 / delta) : 1.0;
}

/// In a difference of two potentials of which one has decayed by 160 digits more, its step is lost to the
/// oracle's rounding.
bool known(const std::vector<Real>& slope, const Exact& e, Quantity q) {
    return norm(slope) >= smallest_norm && norm(slope) >= 1e-160 * norm(components(e.high, q));
}

using WorstOfBoth = std::array<Worst, 2>;

void include(WorstOfBoth& worst, const Point& p) {
    const elastic::Field field({.eta = p.eta, .xi = p.xi});
    const elastic::MediumDerivatives got = elastic::medium_derivatives(field, p.x, p.y, plain);
    for (const By by : {By::eta, By::xi}) {
        const Exact truth = exact(p, by);
        for (int k = 0; k < plain_quantities; ++k) {
            const auto q = static_cast<Quantity>(k);
            const std::vector<Real> slope = quotient(truth, q);
            const auto& mine = by == By::eta ? got.by_eta : got.by_xi;
            if (known(slope, truth, q))
                worst[static_cast<int>(by)].include(
                    q, relative_error(components(mine, q), slope) / allowance(p, by, q), p);
        }
    }
}

void check(const WorstOfBoth& worst) {
    for (int by = 0; by < 2; ++by)
        for (int k = 0; k < plain_quantities; ++k) {
            const Point& p = worst[by].at[k];
            CAPTURE(by, name(static_cast<Quantity>(k)), p.x, p.y, p.xi, p.eta);
            CHECK(worst[by].error[k] <= 1e-10);
        }
}

void print(const WorstOfBoth& worst) {
    for (int by = 0; by < 2; ++by)
        for (int k = 0; k < plain_quantities; ++k)
            std::printf("by %s %-18s worst %.1e at x/xi = %.3g, y/xi = %.3g, eta = %.3g\n",
                        by ? "xi " : "eta", name(static_cast<Quantity>(k)).c_str(), worst[by].error[k],
                        worst[by].at[k].x / worst[by].at[k].xi, worst[by].at[k].y / worst[by].at[k].xi,
                        worst[by].at[k].eta);
}

WorstOfBoth worst_of(int points, std::uint64_t seed) {
    RandomStream random(seed);
    WorstOfBoth worst;
    for (int k = 0; k < points; ++k)
        include(worst, random_point(random, k));
    return worst;
}

} // namespace

TEST_CASE("derivatives by eta and xi agree with the oracle at random points") {
    const WorstOfBoth worst = worst_of(150, 51);
    check(worst);
}

TEST_CASE("derivatives by eta and xi agree with the oracle at 10000 random points", "[.][long]") {
    const WorstOfBoth worst = worst_of(10000, 52);
    print(worst);
    check(worst);
}

TEST_CASE("derivatives by eta and xi where cancellation is worst: in the core, soft, incompressible") {
    WorstOfBoth worst;
    for (const double r : {1e-11, 1e-8, 1e-4, 0.3, 1.0, 30.0, 300.0})
        for (const double eta : {0.0, 1e-12, 1e-6, 1.0, 1e6, 1e12})
            for (const double angle : {0.3, 1.2, 2.4, 3.1})
                include(worst, {2.0 * r * std::cos(angle), 2.0 * r * std::sin(angle), 2.0, eta});
    check(worst);
}

TEST_CASE("only what is wanted of the derivatives is computed, and gradients are refused") {
    const elastic::Field field({.eta = 1.0, .xi = 2.0});
    const auto all = elastic::medium_derivatives(field, 0.5, 0.7, plain);
    const auto strain = elastic::medium_derivatives(field, 0.5, 0.7, {.strain = true});
    CHECK(strain.by_eta.strain.xy == all.by_eta.strain.xy);
    CHECK(strain.by_eta.strain.xy != 0.0);
    CHECK(std::isnan(strain.by_xi.displacement.x));
    CHECK(std::isnan(strain.by_xi.laplacian.x));
    const auto displacement = elastic::medium_derivatives(field, 0.5, 0.7, {.displacement = true});
    CHECK(displacement.by_eta.displacement.x == Approx(all.by_eta.displacement.x).epsilon(1e-14));
    CHECK(displacement.by_xi.displacement.y == Approx(all.by_xi.displacement.y).epsilon(1e-14));
    CHECK_THROWS_AS(elastic::medium_derivatives(field, 0.5, 0.7, oracle::everything), InputError);
    CHECK_THROWS_AS(elastic::medium_derivatives(field, 0.0, 0.0, plain), InputError);
}

TEST_CASE("the comparison of medium derivatives notices a wrong one") {
    const Point p{1.0, 0.5, 2.0, 1.0};
    const elastic::Field near({.eta = 1.0 + 1e-9, .xi = 2.0});
    const auto wrong = elastic::medium_derivatives(near, p.x, p.y, plain);
    const auto slope = quotient(exact(p, By::eta), Quantity::strain);
    CHECK(relative_error(components(wrong.by_eta, Quantity::strain), slope) > 1e-11);
}
