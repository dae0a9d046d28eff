#pragma once
// Exact steady field of one rod moving along +x through the medium, in the rod's own frame.
//
//   -(1/xi) d_x U - lap U - eta grad div U = delta(r) xhat          (paper Eq. (17), U in f/mu)
//
// With c_T = 1/(2 xi), c_L = nu c_T, G_i = exp(-c_i x) K0(c_i r), D = G_T - G_L:
//
//   U = (1/2 pi) [G_T xhat + xi grad D],    div U = (nu/2 pi) d_x G_L,    curl U = -(1/2 pi) d_y G_T
//
// (docs/theory.md Eqs. 5-9). Ahead of the rod U decays exponentially, behind it as |x|^(-1/2), near it as
// -(1 + nu) ln r. Everything is linear in the rod's strength: multiply by f/mu.
//
// Strain and polar vectors come from the kernels' algorithm (wake_kernel.hpp) where it keeps the bounds
// below: eta from 0.1 to 10, 2e-6 < r/xi < 128, nu (r + x) <= 32 xi; polar vectors not within 7 degrees of
// the axis ahead. Elsewhere, and for everything else, the closed form is evaluated; which of the two depends
// on the place and the medium alone.
//
// Accuracy: relative error in the vector or tensor norm typically below 1e-15, of the kernels'
// algorithm below 5e-15 in 99 of 100 places. Bounds held by tests: 2e-13 on the reference table (r/xi in
// [1e-8, 200]); 1e-12 for r/xi in [1e-12, 1e8] and eta in [1e-6, 1e6] wherever the value exceeds 1e-290
// (studies/reports/elastic.md: worst of 30000 points 1.3e-13). Smaller values underflow to 0, never to NaN.
// Close to a point or curve on which a whole vector nearly vanishes the bound is relative to its largest
// part. The gradients and -1 < eta < 0 keep the same bound. Within 1e-90 xi of the rod gradients may
// overflow.
//
//   worst of            U        strain   lap u    grad div u  dipole
//   320 references      8.3e-16  1.1e-14  4.5e-14  4.9e-15     7.7e-15   studies/validate_field.py
//   30000 random points 9.0e-14  1.3e-13  1.1e-13  5.1e-14     5.5e-14   test_elastic "[long]"
//
// Degenerate input (tests/elastic/test_robustness.cpp):
//   eta <= -1 or > 1e12, xi outside [1e-30, 1e30], NaN         InputError, by the constructor
//   eta down to -1 + 1e-15, eta = 1e12, xi = 1e-30 or 1e30     finite values
//   r <= 1e-100 xi, the rod itself                             InputError, whatever is asked for
//   x or y NaN or infinite, r/xi beyond 1e300                  InputError
//   so far off that the value underflows                       0
//   nothing asked for                                          every number is NaN

#include "rodwake/elastic/medium.hpp"

#include <limits>
#include <span>

namespace rodwake::elastic {

// Vectors and symmetric tensors of the plane: turned to other axes, principal axes of the traceless strain
// (paper Fig. attraction a).

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

/// Which quantities to compute; the rest is NaN and costs nothing.
struct FieldRequest {
    bool displacement = false;
    bool strain = false;
    bool polar = false;     ///< lap U and grad div U, the two vectors a polar rod can follow
    bool dipole = false;    ///< field of a y force dipole
    bool gradients = false; ///< also d/dx and d/dy of strain and polar, as far as those are asked for
};

/// One point. Units: displacement f/mu; strain f/mu per length; polar f/mu per length^2; dipole f2 d/mu per
/// length.
struct FieldValues {
    Vector displacement;                ///< U
    SymmetricTensor strain;             ///< (grad U + grad U^T)/2; tr = div U
    Vector laplacian;                   ///< lap U
    Vector gradient_of_trace;           ///< grad div U
    Vector dipole;                      ///< forces +-f2 yhat at y = +-d/2, d -> 0
    SymmetricTensor strain_x, strain_y; ///< d/dx, d/dy of strain
    Vector laplacian_x, laplacian_y;
    Vector gradient_of_trace_x, gradient_of_trace_y;
};

/// What a request for nothing gives: every number is NaN.
constexpr FieldValues unrequested() {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr Vector v{nan, nan};
    constexpr SymmetricTensor t{nan, nan, nan};
    return {v, t, v, v, v, t, t, v, v, v, v};
}

/// The field of a medium, its constants worked out once. Cheap to copy; calls are independent and
/// thread-safe.
class Field {
public:
    /// Throws InputError for an illegal medium (see validate).
    explicit Field(const Medium& medium);

    /// The field at (x, y) in the rod's frame: rod at the origin, heading along +x. Lengths in the unit of
    /// medium.xi. Throws InputError outside the domain above.
    FieldValues at(double x, double y, FieldRequest request) const;

    /// The strain alone: the same bits, sooner.
    SymmetricTensor strain(double x, double y) const;

    const Medium& medium() const { return medium_; }

private:
    friend struct FieldInternals; ///< models/elastic/geometry.hpp

    struct Constants {
        double nu;                          ///< 1/(1 + eta) = c_L/c_T
        double nu_low;                      ///< what rounding nu left out
        double delta;                       ///< 1 - nu = eta/(1 + eta), without cancellation
        double inverse_nu, inverse_root_nu; ///< 1/nu, 1/sqrt(nu)
        double c_shear;                     ///< c_T = 1/(2 xi), 1/length
        double two_xi;
        double lane_reach;         ///< the kernels' algorithm is taken up to this distance, in 2 xi
        const double* bessel_rows; ///< its table of K0 and K1
    };

    FieldValues by_potentials(double x, double y, FieldRequest request) const;

    Medium medium_;
    Constants constants_;
};

// Fields of rods anywhere in the plane: the rod-frame field turned to a rod's heading, and the sum over rods
// (the medium is linear and each rod's field steady in its own frame).
//
//   u(R) = S U(S^T (R - R_b)),  S = rotation by the heading; tensors turn as S eps S^T       (docs/theory.md
//   Eq. 12)

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
