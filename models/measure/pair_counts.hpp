#pragma once
// Sums over all pairs by distance. Distances are made in vectorised rows into a buffer; sums are then taken
// one pair after the other, so that no vector width changes a bit.

#include "rodwake/core/periodic.hpp"
#include "rodwake/measure/window.hpp"

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rodwake::measure {

struct PairSums {
    std::vector<double> pairs; ///< number of pairs with bin k <= distance < bin (k + 1)
    std::vector<double> order; ///< sum of Re psi_i* psi_j over them
};

/// Pairs i < j by their distance to nearest images, floor(distance * (1/bin)); bins * bin <= half the shorter
/// side. Places in the box. `psi` may be empty: its sums are 0.
PairSums count_pairs(const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<std::complex<double>>& psi, const PeriodicBox& box, double bin,
                     std::size_t bins);

/// Of beads in a window: pairs, each weighted by the mean of 1/(share of the circle through the other that
/// lies inside), as seen from the one and from the other. So an ideal gas has as many at r as without a
/// border. Places in the window's box, bins * bin <= half its shorter side.
std::vector<double> count_pairs_in(const Window& window, const std::vector<double>& x,
                                   const std::vector<double>& y, const PeriodicBox& box, double bin,
                                   std::size_t bins);

/// floor(side/2/bin), where a quotient within rounding of a whole number is that number.
std::size_t whole_bins(double side, double bin);

/// g(r) in each bin from the sums over so many frames of so many beads: pairs over those of an ideal gas.
std::vector<double> pair_correlation(const std::vector<double>& pairs, double frames, std::size_t beads,
                                     double area, double bin);
std::vector<double> middles(std::size_t bins, double bin);

// Distances of one bead to many, as bins: the part of the pair loop that is vectorised.

/// Coordinates and psi_6 of beads; each column has room for `padding` more values.
struct PairColumns {
    const double *x, *y, *re, *im;
};

inline constexpr std::size_t padding = 8;

/// Of bead i with each of the `count` beads after it: floor(distance * per_bin) and Re psi_i* psi_j. Places
/// in the box. Writes up to `padding` values more. Every element is on its own, no product is fused: all
/// instruction sets give the same bits.
void fill_pair_row(const PairColumns& beads, std::size_t i, std::size_t count, const PeriodicBox& box,
                   double per_bin, std::int32_t* bin, double* order);

} // namespace rodwake::measure
