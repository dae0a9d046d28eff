#pragma once
// Vectors and symmetric tensors of the plane: turned to other axes, principal axes of the traceless strain
// (paper Fig. attraction a).

namespace rodwake::elastic {

struct Vector {
    double x = 0.0, y = 0.0;
};
struct SymmetricTensor {
    double xx = 0.0, xy = 0.0, yy = 0.0;
};

/// S v and S t S^T, S the rotation by the angle of this cosine and sine.
Vector turned(const Vector& v, double cosine, double sine);
SymmetricTensor turned(const SymmetricTensor& t, double cosine, double sine);

/// The traceless part of a symmetric tensor, as its positive eigenvalue and the axis that belongs to it. The
/// other eigenvalue is -value, along the perpendicular axis.
struct PrincipalAxis {
    double value; ///< >= 0, unit of the tensor
    double angle; ///< of the extensional axis against x, rad, in (-pi/2, pi/2]; 0 where value = 0
};

/// value = hypot((xx - yy)/2, xy), angle = atan2(2 xy, xx - yy)/2. Exact to a few ulp.
PrincipalAxis extensional_axis(const SymmetricTensor& tensor);

} // namespace rodwake::elastic
