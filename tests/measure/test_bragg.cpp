// Bragg peaks of lattices whose reciprocal vectors are known.

#include "catch2/catch.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/measure/bragg.hpp"

#include "granular/packing.hpp"

#include <cmath>

using namespace rodwake;
using measure::BraggPeaks;
using measure::find_peaks;

namespace {

constexpr double degree = M_PI / 180.0;

struct Places {
    std::vector<double> x, y;
};

Places lattice(const granular::LatticeFit& fit, double box) {
    Places places;
    for (const auto& site : granular::lattice_sites(fit, box)) {
        places.x.push_back(site.x());
        places.y.push_back(site.y());
    }
    return places;
}

Places random_places(std::size_t count, double box, std::uint64_t seed) {
    RandomStream random(seed);
    Places places;
    for (std::size_t i = 0; i < count; ++i) {
        places.x.push_back(random.uniform(0.0, box));
        places.y.push_back(random.uniform(0.0, box));
    }
    return places;
}

} // namespace

TEST_CASE("peaks of a perfect lattice have strength 1 and lie at its angle", "[bragg]") {
    for (const double angle : {0.0, 13.0, 30.0, 47.0, 90.0})
        for (const long beads : {60L, 400L, 1549L}) {
            const auto fit = granular::fit_lattice(78.0, beads, angle * degree);
            const auto places = lattice(fit, 78.0);
            const BraggPeaks peaks = find_peaks(places.x, places.y, 78.0);
            INFO(angle << " degrees, " << beads << " beads");
            for (std::size_t k = 0; k < 3; ++k)
                CHECK(peaks.strength[k] == Approx(1.0).epsilon(1e-9)); // rounding of 1e3 products
            CHECK(peaks.m[1] == peaks.m[0] + peaks.m[2]);
            CHECK(peaks.n[1] == peaks.n[0] + peaks.n[2]);
            CHECK(peaks.contrast() > 1e6);
            // rows of a strained lattice are not all 60 degrees apart
            CHECK(std::abs(std::remainder(peaks.row_angle() - fit.orientation, M_PI / 3.0)) <
                  fit.strain + 1e-12);
            CHECK(peaks.row_angle() >= 0.0);
            CHECK(peaks.row_angle() < M_PI / 3.0);
            // of a triangular lattice with the box's area for its points, however strained: exact but for
            // rounding
            const double points = static_cast<double>(places.x.size());
            CHECK(peaks.lattice_spacing() ==
                  Approx(78.0 * std::sqrt(2.0 / (std::sqrt(3.0) * points))).epsilon(1e-12));
        }
}

TEST_CASE("without peaks there is no lattice spacing", "[bragg]") {
    CHECK(BraggPeaks{}.lattice_spacing() == 0.0);
}

TEST_CASE("noise lowers peaks by the Debye-Waller factor; a liquid has none", "[bragg]") {
    auto places = lattice(granular::fit_lattice(78.0, 1549, 0.0), 78.0);
    RandomStream random(5);
    for (std::size_t i = 0; i < places.x.size(); ++i) {
        const double size = 0.1 * std::sqrt(-2.0 * std::log(random.uniform()));
        const double angle = random.uniform(0.0, 2.0 * M_PI);
        places.x[i] = std::fmod(places.x[i] + size * std::cos(angle) + 78.0, 78.0);
        places.y[i] = std::fmod(places.y[i] + size * std::sin(angle) + 78.0, 78.0);
    }
    const BraggPeaks peaks = find_peaks(places.x, places.y, 78.0);
    const double g2 = peaks.G[0].x * peaks.G[0].x + peaks.G[0].y * peaks.G[0].y;
    CHECK(peaks.strength[0] == Approx(std::exp(-0.01 * g2)).margin(0.02)); // scatter 2 x 0.34/sqrt(1554)
    CHECK(peaks.contrast() > 100.0);

    const auto gas = random_places(1549, 78.0, 3);
    const BraggPeaks none = find_peaks(gas.x, gas.y, 78.0);
    CHECK(none.contrast() < 20.0); // largest of 1300 exponentials: 7 +- 1.3
    CHECK(none.liquid_strength == Approx(1.0 / 1549.0).epsilon(0.1)); // 1300 of them: 3 %
}

TEST_CASE("phases give back the displacement they come from", "[bragg]") {
    BraggPeaks peaks;
    peaks.G = {{{3.1, 1.7}, {0.1, 3.4}, {-3.0, 1.7}}};
    const double ux = 0.31, uy = -0.17;
    std::array<double, 3> phase{};
    for (std::size_t k = 0; k < 3; ++k)
        phase[k] = peaks.G[k].x * ux + peaks.G[k].y * uy;
    const auto u = measure::displacement_of(peaks, phase);
    CHECK(u.x == Approx(ux).epsilon(1e-13)); // rounding
    CHECK(u.y == Approx(uy).epsilon(1e-13));
    phase[0] += 0.1;
    CHECK(std::abs(measure::displacement_of(peaks, phase).x - ux) > 0.01);
}

TEST_CASE("peaks of too little are refused", "[bragg]") {
    const std::vector<double> few(5, 0.5), more(20, 0.5);
    CHECK_THROWS_AS(find_peaks(few, few, 1.0), InputError);
    CHECK_THROWS_AS(find_peaks(more, few, 1.0), InputError);
    CHECK_THROWS_AS(measure::displacement_of(BraggPeaks{}, {0.0, 0.0, 0.0}), InputError);
}
