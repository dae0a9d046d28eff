// Triangular lattices in a square box: closed, complete, evenly spaced and as little strained as they say.

#include "rodwake/core/error.hpp"

#include "granular/packing.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace rodwake;
using Eigen::Vector2d;
using granular::fit_lattice;
using granular::LatticeFit;

namespace {

constexpr double degree = M_PI / 180.0;

/// From the first site to all others and to the images of all, sorted by length.
std::vector<Vector2d> steps_from_first(const std::vector<Vector2d>& sites, std::size_t first, double box) {
    std::vector<Vector2d> steps;
    for (std::size_t k = 0; k < sites.size(); ++k)
        for (int i = -1; i <= 1; ++i)
            for (int j = -1; j <= 1; ++j)
                if (k != first || i != 0 || j != 0)
                    steps.push_back(sites[k] - sites[first] + box * Vector2d(i, j));
    std::sort(steps.begin(), steps.end(), [](const auto& u, const auto& v) { return u.norm() < v.norm(); });
    return steps;
}

/// Largest difference between the neighbourhoods of any two sites: 0 for a lattice.
double unevenness(const std::vector<Vector2d>& sites, double box) {
    double worst = 0.0;
    const auto reference = steps_from_first(sites, 0, box);
    for (std::size_t k = 1; k < sites.size(); ++k) {
        const auto here = steps_from_first(sites, k, box);
        for (std::size_t n = 0; n < 12; ++n)
            worst = std::max(worst, std::abs(here[n].norm() - reference[n].norm()));
    }
    return worst;
}

double turned_from(const LatticeFit& fit, double wanted) {
    return std::abs(std::remainder(fit.orientation - wanted, 2.0 * M_PI));
}

} // namespace

TEST_CASE("the bed of the paper is 37 columns and 42 rows, turned by 90 degrees its transpose") {
    const auto fit = fit_lattice(78.0, 1549, 0.0);
    CHECK(fit.sites == 1554);
    CHECK(fit.orientation == 0.0);
    CHECK(fit.spacing == Approx(78.0 / 37.0).epsilon(1e-14)); // rounding
    // rows are 1/42 apart, sites in them 1/37; a perfect triangle has sqrt(3)/2 of that
    CHECK(fit.strain == Approx(std::sqrt(37.0 / 42.0 / std::sqrt(0.75)) - 1.0).epsilon(1e-12));
    const auto across = fit_lattice(78.0, 1549, 0.5 * M_PI);
    CHECK(across.sites == 1554);
    CHECK(across.orientation == Approx(0.5 * M_PI).epsilon(1e-14));
    CHECK(across.strain == Approx(fit.strain).epsilon(1e-10));
    CHECK(across.spacing == Approx(fit.spacing).epsilon(1e-14));
}

TEST_CASE("rows come out within a degree of any wanted angle in the paper's box") {
    for (int k = -12; k <= 12; ++k)
        for (const long beads : {1317L, 1452L, 1549L, 1704L}) {
            const double wanted = k * 5.0 * degree;
            const auto fit = fit_lattice(78.0, beads, wanted);
            INFO(beads << " sites at " << k * 5 << " degrees");
            CHECK(turned_from(fit, wanted) < 1.0 * degree);
            CHECK(fit.sites >= beads);
            CHECK(100 * fit.sites <= 105 * beads); // "a few percent more"
            CHECK(fit.strain < 0.02);              // one row in 78/2.1 = 37 is 2.7 %
        }
}

TEST_CASE("there is a lattice for every number of sites") {
    for (const double wanted : {0.0, 0.3, 1.0, -2.5})
        for (long sites = 1; sites < 400; sites += 1 + sites / 50) {
            const auto fit = fit_lattice(1.0, sites, wanted);
            INFO(sites << " sites at " << wanted);
            REQUIRE(fit.sites >= sites);
            REQUIRE(static_cast<double>(fit.sites) <=
                    1.04 * static_cast<double>(sites) + 2 * std::sqrt(sites) + 2);
            REQUIRE(fit.spacing >
                    0.75 * std::sqrt(2.0 / (std::sqrt(3.0) * static_cast<double>(sites)))); // seen: 0.80
        }
}

TEST_CASE("sites are complete, inside the box and all alike") {
    for (const double wanted : {0.0, 0.2, 0.5 * M_PI, 2.0})
        for (const long least : {1L, 2L, 25L, 97L, 150L}) {
            const auto fit = fit_lattice(3.0, least, wanted);
            const auto sites = granular::lattice_sites(fit, 3.0);
            INFO(least << " sites at " << wanted);
            REQUIRE(static_cast<long>(sites.size()) == fit.sites);
            for (const auto& site : sites)
                REQUIRE((site.minCoeff() >= 0.0 && site.maxCoeff() < 3.0));
            const auto steps = steps_from_first(sites, 0, 3.0);
            CHECK(steps[0].norm() ==
                  Approx(fit.spacing).epsilon(1e-12)); // rounding; no two sites in one place
            if (least < 25) // the twelve nearest may be further than the images looked at
                continue;
            CHECK(unevenness(sites, 3.0) < 1e-13);
            const bool has_row = std::any_of(steps.begin(), steps.begin() + 6, [&](const Vector2d& step) {
                return std::abs(std::remainder(std::atan2(step.y(), step.x()) - fit.orientation,
                                               2.0 * M_PI)) < 1e-12;
            });
            CHECK(has_row); // one of the six nearest lies along the row it reports
        }
}

TEST_CASE("the comparison of neighbourhoods sees one misplaced site") {
    auto sites = granular::lattice_sites(fit_lattice(3.0, 97, 0.0), 3.0);
    sites[40].x() += 1e-6;
    CHECK(unevenness(sites, 3.0) > 1e-7);
}

TEST_CASE("nonsense is refused") {
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        CHECK_THROWS_AS(fit_lattice(bad, 10, 0.0), InputError);
    CHECK_THROWS_AS(fit_lattice(1.0, 0, 0.0), InputError);
    CHECK_THROWS_AS(fit_lattice(1.0, 10, std::numeric_limits<double>::infinity()), InputError);
}
