#pragma once
// The field of one rod in 220-digit arithmetic, by other algebra than models/elastic: every derivative is
// formed directly, with no use of lap G = -2 c d_x G, from
//
//   G_c = exp(-c x) K0(c r),   ((1/r) d/dr)^n K0(c r) = (-c)^n K_n(c r)/r^n                    (DLMF 10.29.4)
//
// so that the medium's equation is a check of the oracle and not a premise. Same units as
// elastic::FieldValues.

#include "multiprecision.hpp"

#include "rodwake/elastic/field.hpp"

#include <array>
#include <string>
#include <vector>

namespace rodwake::oracle {

/// Where, in which medium. The doubles are taken as exact.
struct Point {
    double x, y, xi, eta;
};

/// exp(-c x) K0(c r) and its derivatives up to order four.
class Potential {
public:
    Potential(const Real& x, const Real& y, const Real& c);
    /// d_x^i d_y^j G, i + j <= 4.
    const Real& derivative(int i, int j) const { return table_.at(i).at(j); }

private:
    std::array<std::array<Real, 5>, 5> table_;
};

/// The displacement of a unit force along x or y and its derivatives, i + j <= 3.
class Field {
public:
    /// A medium between the doubles.
    struct Exactly {
        Real xi, eta;
    };
    explicit Field(const Point& at) : Field(at.x, at.y, Exactly{Real(at.xi), Real(at.eta)}) {}
    Field(double x, double y, const Exactly& medium);
    Real ux(int i, int j) const;
    Real uy(int i, int j) const;
    /// div U = (nu/2 pi) d_x G_L: from ux and uy the shear potential would have to cancel, which leaves its
    /// rounding where the longitudinal one has decayed by more than 220 digits below it.
    Real trace(int i, int j) const;
    Real vx(int i, int j) const; ///< of a force along y: Green's tensor is symmetric and its trace is known
    Real vy(int i, int j) const;

private:
    Real xi_, nu_, unit_;
    Potential shear_, longitudinal_;
};

/// What is compared: the five quantities of a point, then their gradients.
enum class Quantity {
    displacement,
    strain,
    laplacian,
    gradient_of_trace,
    dipole,
    strain_gradients,
    laplacian_gradients,
    gradient_of_trace_gradients
};
inline constexpr int plain_quantities = 5, all_quantities = 8;
std::string name(Quantity q);

/// Components such that their Euclidean norm is the vector or tensor norm (xy stands twice).
std::vector<Real> components(const Field& field, Quantity q);
std::vector<double> components(const elastic::FieldValues& f, Quantity q);

} // namespace rodwake::oracle
