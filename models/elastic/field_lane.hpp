#pragma once
// Strain and polar vectors in the rod's frame by the kernels' algorithm, a point in one lane: several times
// faster than the potentials, and as accurate where it answers.

#include "geometry.hpp"

namespace rodwake::elastic {

/// What a FieldRequest for no more than strain and polar asks for.
struct LaneField {
    SymmetricTensor strain;
    Vector laplacian, gradient_of_trace; ///< meaningless unless asked for
};

/// False, and nothing is written: not a point for this route.
bool lane_field(const Constants& medium, double x, double y, bool polar, LaneField& field);

} // namespace rodwake::elastic
