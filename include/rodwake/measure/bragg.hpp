#pragma once
// The first Bragg peaks of a crystal in the periodic box. Only wave vectors 2 pi (m/L_x, n/L_y) fit into the
// box, so they are exact: a crystal that closes in the box has its reciprocal vectors among them.

#include "rodwake/core/periodic.hpp"

#include <array>
#include <complex>
#include <span>
#include <vector>

namespace rodwake::measure {

struct Vector2 {
    double x = 0.0, y = 0.0;

    bool operator==(const Vector2&) const = default;
};

struct BraggPeaks {
    std::array<int, 3> m{}, n{};      ///< G_k = 2 pi (m_k/L_x, n_k/L_y), k = 0, 1, 2; G_1 = G_0 + G_2
    std::array<Vector2, 3> G{};       ///< 1/m
    std::array<double, 3> strength{}; ///< |(1/N) sum exp(i G_k.r)|^2, 1 for a perfect lattice
    double liquid_strength = 0.0;     ///< mean of the same over the ring searched: about S/N of a liquid

    bool operator==(const BraggPeaks&) const = default;
    /// Of the strongest peak over the mean of the ring.
    double contrast() const;
    /// Angle of the close-saved rows from +x, rad, in [0, pi/3).
    double row_angle() const;
    /// Of the triangular lattice whose cell has the area of that of the peaks, m; 0 without peaks.
    double lattice_spacing() const;
};

/// The triple with G_1 = G_0 + G_2 of the largest product of strengths among wave vectors within 12 % of the
/// ring 2 pi/(row distance) of a triangular lattice of this density, each two about 60 degrees apart. The
/// box's whole beads count; places in it. `sites`: how many beads would fill the box, if there are not so
/// many; 0: there are. Deterministic.
BraggPeaks find_peaks(std::span<const double> x, std::span<const double> y, const PeriodicBox& box,
                      double sites = 0.0);

/// u from the three phases G_k.u, least squares: u = (sum G_k G_k^T)^-1 sum G_k phase_k, exact for any
/// triple.
Vector2 displacement_of(const BraggPeaks& peaks, const std::array<double, 3>& phase);

} // namespace rodwake::measure
