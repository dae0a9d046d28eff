#pragma once
// Pieces of a pair's solution, with bounds of the rates of turn along and about them. docs/numerics.md,
// section 4. Reduced units, eta >= 0.

#include "rodwake/elastic/medium.hpp"
#include "rodwake/rods/couplings.hpp"
#include "step_polynomial.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::rods {

/// Bounds about a piece from the bound of the turning rates alone. N: double, or a vector of them.
template<class N>
struct PieceReach {
    N length;    ///< of time
    N distance;  ///< in the middle
    N room;      ///< distance from the piece within which the bounds hold, as a Wandering
    N rate[2];   ///< bound of |theta'| there
    N change[2]; ///< the same for the change of the couplings
    N turn[2];   ///< turn of a heading from its middle
    N rest[3];   ///< of the defect: bound of the interpolation error at the nodes, and rounding
    N direction_rest[2], phase_rest[2]; ///< the same of directions, and of derivatives of rates by phases
    N missed;                           ///< contribution of the rest to the error
};

/// Bounds of the error e over a piece from samples at the nodes: for position, heading 0 and heading 1, and
/// for matrices that map such errors. With e = E + (1 + W) d the rate of d is, but for the mean Jacobian's
/// part and the drift, at most `known` + `wobble` |d| + `inverse` (curvature).
template<class N>
struct PieceExpansion {
    N propagator[4][4]; ///< exp(h J) of the mean Jacobian J, of x, y (of R_0 - R_1) and both headings
    N drift[4];         ///< int exp(s J) ds times the drift of d
    N truncation;       ///< error of both for errors of 1, with positions in units of the scale
    N mean[3];          ///< drift of d
    N swing[3];         ///< |E|
    N turned[3][3];     ///< |W|
    N inverse[3][3];    ///< |(1 + W)^-1|
    N wobble[3][3], known[3];
    N grown[3][3]; ///< 1/(1 - h (|J| + wobble))
    N defect[3];   ///< |p' - f(p)|
    N by[2][3];    ///< |d rate|
    N scale;       ///< of positions, so that both kinds of error count alike
    N growth;      ///< of errors over the piece, about; not finite: the bounds do not hold
};

struct ProofPiece {
    Piece piece;
    int depth = 0;          ///< number of times it may be halved
    std::size_t halves = 0; ///< index of the first half; 0: it is whole
    PieceReach<double> reach;
    PieceExpansion<double> seen;
};

/// Couplings of a pair, and bounds of those of all pairs that a proof is about.
struct PieceCouplings {
    Couplings own, largest, change;
};

void find_reach(const elastic::Medium& medium, const PieceCouplings& couplings, std::span<ProofPiece> pieces);
/// Needs the reach. False if one of these leaves the range of the kernels.
bool expand(const elastic::Medium& medium, const Couplings& couplings, std::span<ProofPiece> pieces,
            std::span<const std::size_t> which);

} // namespace rodwake::rods
