#pragma once
// Boundaries between outcomes as curves: the edges of the finest cells whose ends differ are bisected, and
// the places where the outcome changes are joined from cell to cell.

#include "rodwake/scan/ledger.hpp"
#include "rodwake/scan/refinement.hpp"

namespace rodwake::scan {

/// Edges of finest cells between two outcomes, each once, in the order of their numbers, as brackets one edge
/// long. Ends that failed have no boundary.
std::vector<Crossing> crossed_edges(const Refinement& refinement);

/// The middle of the bracket; its id is that of the edge.
Point middle(const Refinement& refinement, const Crossing& crossing);
/// The half of the bracket whose ends differ: of two, where a third outcome lies between, the lower.
void bisect(Crossing& crossing, const Result& at_middle);

struct BoundaryPoint {
    std::array<double, max_axes> at{};
    double error = 0.0; ///< half the bracket, as a fraction of its axis
};

/// A boundary between two outcomes. Two axes: points in order along it, closed if the last is the first. One
/// axis or three: all points between the two, unordered.
struct Curve {
    std::int32_t outcome_a = -1, outcome_b = -1; ///< a < b
    std::vector<BoundaryPoint> points;
};

std::vector<Curve> boundary_curves(const Refinement& refinement, std::span<const Crossing> crossings);

} // namespace rodwake::scan
