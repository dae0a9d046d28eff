#pragma once
// Sums of field values and their turning to other axes. What was not asked for is NaN and stays so.

#include "rodwake/elastic/field.hpp"

namespace rodwake::elastic {

void add_times(FieldValues& sum, double factor, const FieldValues& f);
inline void add(FieldValues& sum, const FieldValues& f) { add_times(sum, 1.0, f); }

/// To be added to: zero what is asked for.
inline FieldValues empty_sum(FieldRequest request) {
    FieldValues sum = unrequested();
    if (request.displacement)
        sum.displacement = {};
    if (request.strain)
        sum.strain = {};
    if (request.polar)
        sum.laplacian = sum.gradient_of_trace = {};
    if (request.dipole)
        sum.dipole = {};
    return sum;
}

/// Components in axes turned by the angle of this cosine and sine: S v, S t S^T. Gradients, which would turn
/// as third-rank tensors, are left out: NaN.
FieldValues turned(const FieldValues& f, double cosine, double sine);

/// d/d angle of that at 0.
FieldValues turning(const FieldValues& f);

/// In a mirror along x: y components change sign, xy too. Gradients are left out.
FieldValues mirrored(const FieldValues& f);

/// The gradients as fields of their own: those by x in the places of what they are gradients of.
FieldValues gradient_x(const FieldValues& f);
FieldValues gradient_y(const FieldValues& f);
/// And back: into f's gradients.
void set_gradients(FieldValues& f, const FieldValues& by_x, const FieldValues& by_y);

} // namespace rodwake::elastic
