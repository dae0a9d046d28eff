#pragma once
// The reciprocal vectors of a crystal that is seen through a window: no box says which wave vectors there
// are, and the crystal may be turned and strained, a little more in each block of time.
//
// Begins with the best triple of whole numbers of waves across the window, and goes to the maximum of
//
//   sum over frames and k of ln |F_k|,   F_k = sum over beads far from every rod of exp(i G_k.r),
//   G_1 = G_0 + G_2,   each G_k linear in time
//
// which is where the far field's own phases do not wind up in any direction.

#include "rodwake/measure/bragg.hpp"
#include "rodwake/measure/frame.hpp"

#include <array>
#include <span>

namespace rodwake::measure {

struct FarLattice {
    BraggPeaks peaks; ///< at the mean time of the frames
    double time = 0.0;
    std::array<Vector2, 3> rate{}; ///< of G, 1/(m s)

    std::array<Vector2, 3> at(double when) const {
        std::array<Vector2, 3> G = peaks.G;
        for (std::size_t k = 0; k < 3; ++k)
            G[k] = {G[k].x + (when - time) * rate[k].x, G[k].y + (when - time) * rate[k].y};
        return G;
    }
};

/// Of the frames together; far: farther than this from every rod that is seen, m. Throws InputError for too
/// few beads, RunError where no triple is found. Strengths are those of the first frame's far field.
FarLattice far_lattice(std::span<const Frame> frames, const Layout& layout, double far_from);

} // namespace rodwake::measure
