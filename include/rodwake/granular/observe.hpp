#pragma once
// What one instant of a run looks like in a few numbers.

#include "rodwake/granular/problem.hpp"

#include <array>
#include <vector>

namespace rodwake::granular {

/// Granular temperatures of the beads, per mass, the motion of their centre of mass removed, m^2/s^2.
struct Temperatures {
    double xy = 0.0; ///< (var v_x + var v_y)/2
    double z = 0.0;  ///< var v_z
};

/// Parts xx, xy and yy of a symmetric tensor in the plane.
using PlaneTensor = std::array<double, 3>;

/// What a sample asks of all beads, in one pass.
struct Agitation {
    Temperatures temperatures;
    /// Sum over beads and rods of m (v - V)(v - V)^T in the plane, V that of the beads' centre of mass, J.
    PlaneTensor momentum_flux{};
    /// The temperatures of each kind, about the mean velocity V of all beads; empty if there is one kind.
    std::vector<Temperatures> of_kinds = {};
};

/// Pressure tensor of the layer in the plane, N/m, as momentum that crosses a line per time and length, mean
/// over the box and over a time t (Irving & Kirkwood, J. Chem. Phys. 18, 817, 1950); positive: the bed pushes
/// outwards.
///
///   p_ab = (1/(L_x L_y)) [ < sum_i m_i (v_ia - V_a)(v_ib - V_b) > + (1/t) sum_k (r_ka P_kb + r_kb P_ka)/2 ]
///
/// i: beads and rods, V the velocity of the beads' centre of mass. k: impulses between two bodies, r from the
/// centre of mass of the second to that of the first, P on the first. What the plates do acts on single
/// bodies: it is no part of it. J, J, s, m^2; where no time has passed (0 s) the first part alone.
PlaneTensor pressure(const PlaneTensor& momentum_flux, const PlaneTensor& virial, double time, double area);

/// Mean over the directions.
inline double isotropic(const PlaneTensor& pressure) { return (pressure[0] + pressure[2]) / 2.0; }

/// Whether the beads have stopped moving sideways between vibrating plates: an absorbing state, in which each
/// bead bounces in step with the plates, or by itself, and meets no other. T.xy is then at most 3e-5 of the
/// square of the plates' largest speed, Gamma g/(2 pi f); that of a bed that moves is 1e-3 to 1e-1 of it, and
/// without collisions friction with the plates takes it to zero exponentially. T is that of beads far from
/// the rods, which stir those around them (Simulation::far_temperatures). Never of fewer than two beads, nor
/// of static plates.
bool in_absorbing_state(const Temperatures& T, const GranularProblem& problem);

/// J; potential above z = 0. Spins of beads and rods are part of the kinetic energy.
struct Energy {
    double kinetic = 0.0, potential = 0.0;
};

/// Cut-off for the neighbours of a bead, between the first and second shell: 1.4 spacings of the perfect
/// triangular lattice of this area fraction, d = 2 a sqrt(0.9069/phi_b), m; of several sizes a is the root of
/// the mean square of their radii. phi_b > 0.
double neighbour_cutoff(double bead_radius, double phi_b);

} // namespace rodwake::granular
