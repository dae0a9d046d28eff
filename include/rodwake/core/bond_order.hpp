#pragma once
// Bond-orientational order in the periodic plane, by whatever rule beads are neighbours:
//
//   psi_6,i = (1/N_i) sum_j exp(6 i theta_ij) over the N_i neighbours of bead i; 0 without any
//
// theta_ij is the angle of the bond from i to j, from +x.

#include "rodwake/core/periodic.hpp"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace rodwake {

/// From one bead to a neighbour (perhaps an image); a list of bonds has each once from either end.
struct Bond {
    std::size_t from = 0, to = 0;
    double dx = 0.0, dy = 0.0;
};

/// To all beads nearer than the cut-off, by nearest images; beads in exactly one place have no direction and
/// are no neighbours. Places anywhere. Sorted by (from, to), so sums over them depend on the places alone.
std::vector<Bond> bonds_within(std::span<const double> x, std::span<const double> y, const PeriodicBox& box,
                               double cutoff);

struct LocalOrder {
    std::vector<std::complex<double>> psi; ///< psi_6 of each bead
    std::vector<int> neighbours;

    double mean_size() const; ///< of |psi|
    double mean_neighbours() const;
    /// |mean of psi|: 1 for one perfect crystal, about 1/sqrt(N) for a fluid; 0 without beads.
    double global() const;
};

/// Sums in the order of the bonds.
LocalOrder bond_order(std::size_t beads, std::span<const Bond> bonds);

} // namespace rodwake
