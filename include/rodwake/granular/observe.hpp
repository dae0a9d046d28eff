#pragma once
// What one instant of a run looks like in a few numbers.

#include <complex>
#include <vector>

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

/// Bond-orientational order of one bead: psi_6 = (1/n) sum exp(6 i angle) over the n beads nearer in the
/// plane than the cut-off; 0 without any. Angles from +x.
std::vector<std::complex<double>> local_psi6(const std::vector<double>& x, const std::vector<double>& y,
                                             double box, double cutoff);

/// |mean of psi_6 over the beads|: 1 for one perfect crystal, about 1/sqrt(N) for a fluid.
double global_psi6(const std::vector<double>& x, const std::vector<double>& y, double box, double cutoff);

} // namespace rodwake::granular
