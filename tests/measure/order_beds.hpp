#pragma once
// Beds whose order is known, and order straight from its definition: all pairs, angles by atan2.

#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/measure/order.hpp"

#include <cmath>
#include <complex>
#include <vector>

namespace order_beds {

struct Bed {
    std::vector<double> x, y;
    double box = 0.0;
};

inline constexpr double radius = 4e-4;

inline Bed random_bed(std::size_t count, double box, std::uint64_t seed) {
    rodwake::RandomStream random(seed);
    Bed bed{{}, {}, box};
    for (std::size_t i = 0; i < count; ++i) {
        bed.x.push_back(random.uniform(0.0, box));
        bed.y.push_back(random.uniform(0.0, box));
    }
    return bed;
}

/// A hexagon of perfect triangular lattice, `shells` around its middle, which is bead 0; no such lattice
/// closes in a square box.
inline Bed hexagon(int shells, double spacing, double turn, double box) {
    Bed bed{{0.5 * box}, {0.5 * box}, box};
    for (int i = -shells; i <= shells; ++i)
        for (int j = -shells; j <= shells; ++j) {
            if ((i == 0 && j == 0) || std::abs(i + j) > shells)
                continue;
            const double u = spacing * (i + 0.5 * j), v = spacing * std::sqrt(0.75) * j;
            bed.x.push_back(0.5 * box + u * std::cos(turn) - v * std::sin(turn));
            bed.y.push_back(0.5 * box + u * std::sin(turn) + v * std::cos(turn));
        }
    return bed;
}

inline Bed square_lattice(std::size_t side, double box) {
    Bed bed{{}, {}, box};
    for (std::size_t i = 0; i < side * side; ++i) {
        bed.x.push_back(box / static_cast<double>(side) * (static_cast<double>(i % side) + 0.3));
        bed.y.push_back(box / static_cast<double>(side) * (static_cast<double>(i / side) + 0.7));
    }
    return bed;
}

inline Bed shifted(Bed bed, double dx, double dy) {
    for (double& x : bed.x)
        x = rodwake::into_box(x + dx, bed.box);
    for (double& y : bed.y)
        y = rodwake::into_box(y + dy, bed.box);
    return bed;
}

/// Triangular rows squeezed to fit the box, every bead moved a little: a crystal with a first minimum.
inline Bed crystal(std::size_t columns, std::size_t rows, double box, double noise, std::uint64_t seed) {
    rodwake::RandomStream random(seed);
    Bed bed{{}, {}, box};
    for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t i = 0; i < columns; ++i) {
            const double column = static_cast<double>(i) + (j % 2 == 0 ? 0.25 : 0.75);
            const double row = static_cast<double>(j) + 0.5;
            bed.x.push_back(rodwake::into_box(
                box * column / static_cast<double>(columns) + random.uniform(-noise, noise), box));
            bed.y.push_back(rodwake::into_box(
                box * row / static_cast<double>(rows) + random.uniform(-noise, noise), box));
        }
    return bed;
}

inline std::vector<std::complex<double>> plain_psi6(const Bed& bed, double cutoff) {
    std::vector<std::complex<double>> psi(bed.x.size());
    for (std::size_t i = 0; i < psi.size(); ++i) {
        double near = 0.0;
        for (std::size_t j = 0; j < psi.size(); ++j) {
            const double dx = std::remainder(bed.x[j] - bed.x[i], bed.box),
                         dy = std::remainder(bed.y[j] - bed.y[i], bed.box);
            if (i == j || std::hypot(dx, dy) >= cutoff)
                continue;
            psi[i] += std::polar(1.0, 6.0 * std::atan2(dy, dx));
            near += 1.0;
        }
        psi[i] /= std::max(near, 1.0);
    }
    return psi;
}

inline rodwake::measure::Layout layout_of(const Bed& bed) { return {bed.box, radius, 7e-7, bed.x.size(), 0}; }

inline rodwake::measure::Frame frame_of(const Bed& bed, double time) {
    const std::vector<double> none(bed.x.size(), 0.0);
    return {time, bed.x, bed.y, bed.x, bed.y, none, none, {}};
}

inline rodwake::measure::OrderOptions options() {
    rodwake::measure::OrderOptions k;
    k.bin = 0.05 * radius;
    k.order_bin = radius;
    return k;
}

} // namespace order_beds
