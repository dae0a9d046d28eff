#pragma once
// Principal axes of the traceless strain (paper Fig. attraction a).

#include "rodwake/elastic/field.hpp"

namespace rodwake::elastic {

/// The traceless part of a symmetric tensor, as its positive eigenvalue and the axis that belongs to it. The
/// other eigenvalue is -value, along the perpendicular axis.
struct PrincipalAxis {
    double value; ///< >= 0, unit of the tensor
    double angle; ///< of the extensional axis against x, rad, in (-pi/2, pi/2]; 0 where value = 0
};

/// value = hypot((xx - yy)/2, xy), angle = atan2(2 xy, xx - yy)/2. Exact to a few ulp.
PrincipalAxis extensional_axis(const SymmetricTensor& tensor);

} // namespace rodwake::elastic
