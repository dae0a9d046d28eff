#pragma once
// Sums of current correlations over blocks of time of all runs, the modes (m, n) and (m, -n) put together,
// and the correlations of the two branches that they give.

#include "rodwake/measure/phonons.hpp"

#include <span>
#include <utility>
#include <vector>

namespace rodwake::measure {

/// What is summed over blocks.
struct PhononSums {
    PhononAccumulator::PhononBlock block;
    std::vector<double> squares; ///< [u_L, u_T][mode], variance of u N within a block, times displacements
    double displacements = 0.0;
};

/// Of all runs, at most 64: successive ones are put together where there are more. A last one of less than
/// half the frames goes to the one before.
std::vector<PhononSums> phonon_blocks(std::span<const PhononAccumulator> runs);

/// All of them together but one; none is left out for without = blocks.size().
PhononSums pooled(const std::vector<PhononSums>& blocks, std::size_t without);

/// (m, n) and (m, -n), m and n not negative.
struct MirrorModes {
    int m = 0, n = 0;
    std::vector<std::pair<std::size_t, double>> members; ///< number of the mode, sign of its LT
};

/// By m^2 + n^2.
std::vector<MirrorModes> mirror_modes(std::span<const PhononAccumulator::Mode> modes);

/// Per bead, [lag], m^2/s^2.
struct CurrentCorrelations {
    std::vector<double> LL, TT, LT;
};

CurrentCorrelations correlations_of(const PhononSums& sums, const MirrorModes& mirrored, std::size_t modes,
                                    double beads);

/// Angle from q within (-45, 45] degrees at which the sum of squares of the cross correlation over the lags
/// after 0 is least, rad (Cardoso and Souloumiac, SIAM J. Matrix Anal. Appl. 17, 161 (1996)).
double polarisation_of(const CurrentCorrelations& c);

/// LL and TT along axes turned by the angle, rad; LT is left as it was.
CurrentCorrelations turned(const CurrentCorrelations& c, double angle);

} // namespace rodwake::measure
