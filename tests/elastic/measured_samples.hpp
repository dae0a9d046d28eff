#pragma once
// Measured fields that are known: the exact field of one medium on a grid, with errors of known size.

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/measured_field.hpp"

#include <cmath>
#include <numbers>

namespace measured_samples {

using namespace rodwake::elastic;

constexpr Medium truth{1.3, 5.0}, theory{0.8, 4.0};
constexpr double box = 24.0, core = 2.0, blend = 2.0, edge = 10.5;

inline double normal(rodwake::RandomStream& random) {
    const double length = std::sqrt(-2.0 * std::log(random.uniform()));
    return length * std::cos(2.0 * std::numbers::pi * random.uniform());
}

/// Independent errors of `sigma`, drawn if `noise`.
inline MeasuredGrid sampled(std::size_t n, double sigma, bool noise, std::uint64_t seed = 1) {
    MeasuredGrid grid{.n = n, .spacing = box / static_cast<double>(n), .Ux = {}, .Uy = {}, .sigma_x = {}};
    rodwake::RandomStream random(seed);
    const auto wake = exact_field(truth, box)->wake(0.0);
    for (std::size_t bin = 0; bin < n * n; ++bin) {
        const double x = grid.place(bin % n), y = grid.place(bin / n);
        const bool known = std::hypot(x, y) > 1.0;
        const Vector u = known ? wake->at(x, y, {.displacement = true}).displacement : Vector{};
        grid.Ux.push_back(u.x + (noise ? sigma * normal(random) : 0.0));
        grid.Uy.push_back(u.y + (noise ? sigma * normal(random) : 0.0));
        grid.known.push_back(known);
    }
    grid.sigma_x.assign(n * n, sigma);
    grid.sigma_y.assign(n * n, sigma);
    return grid;
}

inline MeasuredOptions options(std::optional<double> smoothing = {}) {
    return {.core = core, .edge = edge, .blend = blend, .smoothing = smoothing};
}

} // namespace measured_samples
