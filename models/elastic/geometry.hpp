#pragma once
// Where a point lies relative to the rod, in the variables of the closed form. Decay exponents are carried in
// double-double where they are large: an exponent of 600 rounded to double would cost exp() three digits.

#include "double_double.hpp"
#include "rodwake/elastic/field.hpp"

namespace rodwake::elastic {

/// What a Field has worked out of its medium, for this part alone.
struct FieldInternals {
    using Constants = Field::Constants;
    static const Constants& constants(const Field& field) { return field.constants_; }
    /// By the closed form alone, which the faster route of Field::at is tested against.
    static FieldValues by_potentials(const Field& field, double x, double y, FieldRequest request) {
        return field.by_potentials(x, y, request);
    }
};
using Constants = FieldInternals::Constants;

/// A point in units of 1/c_T = 2 xi: X = x c_T, Y = y c_T, s = r c_T > 0.
struct Geometry {
    double x, y; ///< as given
    double X, Y, s;
    double inverse; ///< 1/s
    double root;    ///< sqrt(pi/(2 s)), K0 and K1 far out
    double c, q;    ///< X/s = cos, Y/s = sin of the angle from the heading
    double p, n;    ///< 1 + c and 1 - c, each accurate where it is small: on the wake axis, on the axis ahead
    DoubleDouble w; ///< s + X, the shear exponent; Y^2/(s - X) behind
    double boost; ///< power of two on every exponential far ahead, lest one underflow that a unit would lift
                  ///< again

    /// Throws InputError unless the point is finite and off the rod.
    Geometry(const Constants& medium, double x, double y);
};

/// A wave number a of a potential in units of c_T, with what of it costs a division or a root.
struct WaveNumber {
    DoubleDouble a;
    double inverse, inverse_root; ///< 1/a, 1/sqrt(a)
};

/// Product of an exponent and a wave number; rounded to double where that is enough.
DoubleDouble times(DoubleDouble a, DoubleDouble b);

/// boost exp(-exponent), relative error <= 4 ulp however large the exponent.
double exp_minus(DoubleDouble exponent, double boost);

// Strain and polar vectors in the rod's frame by the kernels' algorithm, a point in one lane: twice as fast
// as the potentials, and as accurate where it answers.

/// Largest r/(2 xi) of this route; 0: it does not suit the medium.
double lane_reach(const Medium& medium);

/// False, and nothing is written: not a point for this route. With polar vectors the strain has the same
/// bits.
bool lane_strain(const Constants& medium, double x, double y, SymmetricTensor& strain);
bool lane_strain_and_polar(const Constants& medium, double x, double y, FieldValues& field);

} // namespace rodwake::elastic
