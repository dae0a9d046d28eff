// How a measured field is smoothed, and what its errors make of it.

#include "measured_samples.hpp"

#include <catch2/catch.hpp>

#include <vector>

using namespace rodwake;
using namespace measured_samples;

namespace {

constexpr Vector place{5.0, 3.0};

double strain_at(const WakeField& field, Vector p = place) {
    return field.wake(0.0)->at(p.x, p.y, {.strain = true}).strain.xx;
}

double deviation(const std::vector<double>& values) {
    double mean = 0.0, square = 0.0;
    for (const double v : values)
        mean += v / static_cast<double>(values.size());
    for (const double v : values)
        square += (v - mean) * (v - mean);
    return std::sqrt(square / static_cast<double>(values.size() - 1));
}

std::vector<double> draws(const MeasuredDisplacement& measured, std::uint32_t count, std::uint64_t seed = 5) {
    std::vector<double> values;
    for (std::uint32_t k = 0; k < count; ++k)
        values.push_back(strain_at(*measured.drawn(seed, k)));
    return values;
}

/// Root mean square of exx - exact between 4 and 9 from the rod.
double strain_error(const MeasuredDisplacement& measured) {
    const auto wake = measured.field(box)->wake(0.0), exact = exact_field(truth, box)->wake(0.0);
    double square = 0.0, count = 0.0;
    for (double r = 4.5; r < 9.0; r += 1.0)
        for (double angle = 0.1; angle < 6.2; angle += 0.3, count += 1.0) {
            const double x = r * std::cos(angle), y = r * std::sin(angle);
            const double off =
                wake->at(x, y, {.strain = true}).strain.xx - exact->at(x, y, {.strain = true}).strain.xx;
            square += off * off;
        }
    return std::sqrt(square / count);
}

/// Errors that are means over a window of radius R, as rodwake measure makes them.
MeasuredGrid with_correlated_errors(std::size_t n, double sigma, double R) {
    MeasuredGrid grid = sampled(n, sigma, false);
    const auto side = static_cast<long>(n), reach = static_cast<long>(R / grid.spacing);
    RandomStream random(11);
    for (auto* U : {&grid.Ux, &grid.Uy}) {
        std::vector<double> white(n * n);
        for (double& z : white)
            z = normal(random);
        for (long row = 0; row < side; ++row)
            for (long column = 0; column < side; ++column) {
                double sum = 0.0, square = 0.0;
                for (long j = -reach; j <= reach; ++j)
                    for (long i = -reach; i <= reach; ++i) {
                        const double r = std::hypot(i, j) * grid.spacing / R;
                        const double weight = std::max(0.0, 1.0 - r * r);
                        sum += weight * white[static_cast<std::size_t>((row + j + side) % side * side +
                                                                       (column + i + side) % side)];
                        square += weight * weight;
                    }
                (*U)[static_cast<std::size_t>(row * side + column)] += sigma * sum / std::sqrt(square);
            }
    }
    return grid;
}

} // namespace

TEST_CASE("cross-validation smooths as much as the errors ask for") {
    double before = 0.0;
    for (const double sigma : {1e-3, 1e-2, 1e-1}) {
        const MeasuredGrid grid = sampled(32, sigma, true);
        const MeasuredDisplacement chosen(grid, theory, options());
        const SmoothingReport& x = chosen.report_x();
        CHECK(x.lambda > 3.0 * before); // more with larger errors
        before = x.lambda;
        // chi2 of points - tr(H), to 4 of its standard deviations
        const double left = static_cast<double>(x.points) - x.trace;
        CHECK(std::abs(x.chi2 - left) < 4.0 * std::sqrt(2.0 * left));
        const double error = strain_error(chosen);
        for (const double factor : {1e-3, 1e3}) // and no other smoothing is much better
            CHECK(error < 1.2 * strain_error(MeasuredDisplacement(grid, theory, options(factor * x.lambda))));
    }
}

TEST_CASE("errors that neighbours share are not taken for signal") {
    constexpr double R = 1.7;
    const MeasuredGrid grid = with_correlated_errors(32, 1e-2, R);
    MeasuredOptions told = options();
    told.window = R;
    const MeasuredDisplacement with(grid, theory, told), without(grid, theory, options());
    CHECK(with.report_x().lambda > 10.0 * without.report_x().lambda);
    CHECK(strain_error(with) < 0.7 * strain_error(without));
}

TEST_CASE("the spread of draws is the error that the sigmas make") {
    MeasuredGrid grid = sampled(24, 0.02, false);
    std::vector<std::size_t> bins; // only these have errors: the others keep their weight
    for (std::size_t bin = 0; bin < grid.known.size(); ++bin) {
        const double x = grid.place(bin % 24), y = grid.place(bin / 24);
        grid.known[bin] = std::hypot(x - place.x, y - place.y) < 3.5;
        if (grid.known[bin])
            bins.push_back(bin);
    }
    for (const std::size_t bin : bins) // of all sizes
        grid.sigma_x[bin] *= 0.5 + 0.1 * static_cast<double>(bin % 24);
    const MeasuredDisplacement measured(grid, theory, options(0.03));
    double variance = 0.0;
    const double unmoved = strain_at(*measured.field());
    for (const std::size_t bin : bins) { // smoothing is linear: each sigma by itself
        MeasuredGrid moved = grid;
        moved.Ux[bin] += grid.sigma_x[bin];
        const double change =
            strain_at(*MeasuredDisplacement(moved, theory, options(0.03)).field()) - unmoved;
        variance += change * change;
    }
    constexpr std::uint32_t count = 400; // the deviation is then known to 3.5 %; three of that
    CHECK(deviation(draws(measured, count)) == Approx(std::sqrt(variance)).epsilon(0.11));
    for (auto* sigma : {&grid.sigma_x, &grid.sigma_y})
        for (double& s : *sigma)
            s *= 2.0;
    const MeasuredDisplacement twice(grid, theory, options(0.03));
    CHECK(deviation(draws(twice, 20)) ==
          Approx(2.0 * deviation(draws(measured, 20))).epsilon(1e-9)); // the same draws
}

TEST_CASE("errors that go together are not averaged out, and over a long way they strain little") {
    std::vector<double> strain, displacement;
    for (const double radius : {0.0, 2.0, 10.0}) {
        MeasuredOptions chosen = options(0.03);
        chosen.correlation = radius;
        const MeasuredDisplacement measured(sampled(24, 0.02, false), theory, chosen);
        strain.push_back(deviation(draws(measured, 40)));
        std::vector<double> u; // against theory, which keeps its place at the edge
        for (std::uint32_t k = 0; k < 40; ++k)
            u.push_back(
                measured.drawn(5, k)->wake(0.0)->at(place.x, place.y, {.displacement = true}).displacement.x);
        displacement.push_back(deviation(u));
    }
    CHECK(strain[1] > 1.5 * strain[0]); // within the reach of the smoothing
    CHECK(strain[2] < 0.8 * strain[1]);
    CHECK(displacement[1] > 1.5 * displacement[0]);
    CHECK(displacement[2] > 0.8 * displacement[1]);
}

TEST_CASE("draws depend on seed and sample alone") {
    const MeasuredDisplacement measured(sampled(24, 0.02, false), theory, options(0.03));
    CHECK(strain_at(*measured.drawn(5, 3)) == strain_at(*measured.drawn(5, 3)));
    CHECK(strain_at(*measured.drawn(5, 3)) != strain_at(*measured.drawn(5, 4)));
    CHECK(strain_at(*measured.drawn(5, 3)) != strain_at(*measured.drawn(6, 3)));
}

TEST_CASE("a constant in a measured field makes no strain") {
    MeasuredGrid grid = sampled(24, 0.02, true);
    const auto plain = MeasuredDisplacement(grid, theory, options(0.1)).field();
    for (double& u : grid.Ux)
        u += 3.0;
    const auto lifted = MeasuredDisplacement(grid, theory, options(0.1)).field();
    for (const Vector p : {place, Vector{9.7, 2.0}, Vector{-4.0, -9.9}})
        CHECK(strain_at(*lifted, p) ==
              Approx(strain_at(*plain, p)).margin(1e-9)); // rounding of 3 over the blend
}
