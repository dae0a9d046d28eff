#pragma once
// What one instant of a run looks like in a few numbers.

namespace rodwake::granular {

/// Granular temperatures of the beads, per mass, the motion of their centre of mass removed, m^2/s^2.
struct Temperatures {
    double xy = 0.0; ///< (var v_x + var v_y)/2
    double z = 0.0;  ///< var v_z
};

/// J; potential above z = 0. Spins of beads and rods are part of the kinetic energy.
struct Energy {
    double kinetic = 0.0, potential = 0.0;
};

/// Cut-off for the neighbours of a bead, between the first and second shell: 1.4 spacings of the perfect
/// triangular lattice of this area fraction, d = 2 a sqrt(0.9069/phi_b), m. phi_b > 0.
double neighbour_cutoff(double bead_radius, double phi_b);

} // namespace rodwake::granular
