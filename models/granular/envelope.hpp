#pragma once
// Outline of a row of overlapping spheres turned about its axis: R(x)^2 = max_k (r_k^2 - (x - c_k)^2). Two of
// these parabolas differ by a straight line, so they meet once and the outline is a chain of pieces, one
// sphere each.

#include <vector>

namespace rodwake::granular {

/// R(x)^2 = radius^2 - (x - centre)^2 for from <= x <= to.
struct OutlinePiece {
    double centre, radius, from, to;
};

/// Pieces from left to right. Centres increase; neighbours overlap.
std::vector<OutlinePiece> outline(const std::vector<double>& centre, const std::vector<double>& radius);

/// Integrals along the whole axis, about x = 0.
struct OutlineIntegrals {
    double r1 = 0.0;    ///< of R
    double r2 = 0.0;    ///< of R^2
    double x_r2 = 0.0;  ///< of x R^2
    double x2_r2 = 0.0; ///< of x^2 R^2
    double r4 = 0.0;    ///< of R^4
};

OutlineIntegrals integrate(const std::vector<OutlinePiece>& pieces);

} // namespace rodwake::granular
