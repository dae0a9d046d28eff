#pragma once
// Distances of one bead to many, as bins: the part of the pair loop that is vectorised.

#include "rodwake/core/periodic.hpp"

#include <cstddef>
#include <cstdint>

namespace rodwake::measure {

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
