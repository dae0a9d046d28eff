#pragma once
// Whether two rods end in a stable orbit about each other, decided from their positions.
//
// With q the pose of one rod in the frame of the other and f the pair's flow (pair_equilibria.hpp):
//   1. Newton's method from q converges to an orbit q* (omega != 0), in the image that the rods are in.
//   2. All eigenvalues of the Jacobian J at q* have negative real parts.
//   3. q is in its basin. With d = ((x - x*)/r*, (y - y*)/r*, h - h*) and c = T^-1 d its components along the
//      eigenvectors of unit length, V = |c|^2 falls near q* as V' <= -2 m V, -m being the largest real part.
//      The ellipsoid V <= V(q) is looked at in 96 directions and four sizes: everywhere V' <= -m V must
//      hold. Then no path leaves the ellipsoid, and all that start in it come to q*, as exp(-m t/2) or
//      sooner.
//   4. No pose of the ellipsoid is within the contact distance.
//
// So it is decided before the rods have settled, and separation and omega are those of the orbit itself,
// solved to rounding, not those of the last pose. Errors: the criterion is sufficient, not necessary. Rods
// farther out than 1 to 5 % of r* and of a radian (five orbits tried) are found later or not at all; so are
// those next to a fold, where m vanishes, and where eigenvectors become parallel. Condition 3 is sampled, 0.2
// rad apart, not proved; V'/V would have to change by m in between. Nothing is said of rods in a periodic
// box, in another field, or with noise or rows.

#include "rodwake/rods/pair_equilibria.hpp"

#include <optional>
#include <string>

namespace rodwake::rods {

/// Pose of a rod in the frame of another.
Pose pose_seen_from(const Pose& from, const Pose& rod);

struct SettledOrbit {
    PairEquilibrium orbit; ///< in the image the rods are in, omega signed
    double decay;          ///< the slowest rate at which rods come to it, mu v0/f
    double distance;       ///< |d| now
};

/// Nothing unless all of the above hold; `failed` then gets the words for what does not.
std::optional<SettledOrbit> settled_orbit(const elastic::Medium& medium, const Couplings& couplings,
                                          const Pose& rod0, const Pose& rod1,
                                          std::optional<double> contact_distance = {},
                                          std::string* failed = nullptr);

} // namespace rodwake::rods
