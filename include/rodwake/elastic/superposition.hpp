#pragma once
// Fields of rods anywhere in the plane: the rod-frame field turned to a rod's heading, and the sum over rods
// (the medium is linear and each rod's field steady in its own frame).
//
//   u(R) = S U(S^T (R - R_b)),  S = rotation by the heading; tensors turn as S eps S^T       (docs/physics.md
//   Eq. 12)

#include "rodwake/elastic/field.hpp"

#include <span>

namespace rodwake::elastic {

/// A rod as a source: position in the lab frame, heading in rad, counter-clockwise from +x.
struct Source {
    double x = 0.0, y = 0.0, heading = 0.0;
};

/// Field of one source at (x, y), in lab components. Throws InputError at the source. Gradients are not
/// turned and so NaN: ask for them in the rod's frame (Field::at).
FieldValues lab_field(const Field& field, const Source& source, double x, double y, FieldRequest request);

/// Sum of lab_field over the sources, in their order. Without sources every number is 0, asked for or not;
/// with sources what was not asked for is NaN. Gradients are 0 always: they are not summed. Throws InputError
/// at a source and for places that are not finite.
FieldValues superpose(const Field& field, std::span<const Source> sources, double x, double y,
                      FieldRequest request);

} // namespace rodwake::elastic
