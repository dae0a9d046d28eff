#pragma once
// Fixed points of a pair's flow: what two rods in each other's steady wakes can do for ever.
//
// The frame is that of rod 0, q = (x, y, h) the pose of rod 1 in it (rod 0 at the origin, heading along +x).
// With w_0 and w_1 the turning rates of rods/model.hpp and v0 = 1:
//
//   x' = cos h - 1 + w_0 y,    y' = sin h - w_0 x,    h' = w_1 - w_0
//
// A fixed point with w_0 = w_1 = w has both rods on one circle, x = sin h/w, y = (1 - cos h)/w, so rod 1 is
// in direction h/2: two unknowns are left, the separation r and h. Let T(x, y, h) be the rate at which the
// wake of a rod turns another one at (x, y) with heading h, T+- that at +-r (cos b, sin b), b = |h|/2. Rods
// on the circle turn alike, and as fast as they go round, where
//
//   T+ + T- = 0        (a)            r (T+ - T-)/2 = 2 sin b        (b)        omega = 2 sin b/r
//
// (a) is homogeneous in the couplings: with kappa alone its zeros in (r/xi, b) depend on eta and on nothing
// else, and (b) then says which kappa each of them needs. At b = pi/2, rods opposite each other on the
// circle, (a) is an identity, by symmetry. Four kinds of fixed points follow:
//
//   orbit      on the circle, b in (0, pi/2). Of the four poses that mirroring and exchange of the rods make
//              of each other the one with omega > 0 and rod 0 in front (x <= 0) is reported; so y > 0 > h.
//              Opposite rods are pose (0, r, -pi)
//   parallel   side by side or in echelon, omega = h = 0, y > 0 >= x: T+ = T- = 0 at heading 0. With kappa
//              alone there is none (looked for at eta of 0.1, 1 and 10, r/xi of 1e-3 to 30)
//   in_line    y = h = 0, rod 0 in front, at any distance D, with an eigenvalue 0 along this line
//
// Lengths f/mu, times f/(mu v0), eigenvalues mu v0/f. The infinite plane, the exact field
// (elastic/field.hpp).
//
// Error: the equations are solved to rounding. Rates at the fixed point vanish to 1e-10 of the Jacobian's
// norm and eigenvalues are those of differences to 1e-5 of the largest, both in the lab's equations
// (tests/rods/test_pair_equilibria.cpp). Next to a fold, where two orbits merge, r is known to the root of
// rounding.
//
// Degenerate input:
//   an illegal medium                             InputError (elastic/medium.hpp)
//   no coupling                                   in line alone, one interval, all eigenvalues 0
//   a coupling that is NaN or infinite            InputError

#include "rodwake/elastic/medium.hpp"
#include "rodwake/rods/couplings.hpp"
#include "rodwake/rods/model.hpp"

#include <array>
#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::rods {

/// Distances in which fixed points are looked for, in xi.
inline constexpr double least_searched = 1e-3, most_searched = 30.0;

/// The flow at q = (x, y, h), and its Jacobian: by_pose(i, j) = d rates_i/d q_j.
struct PairFlow {
    Eigen::Vector3d rates;
    Eigen::Matrix3d by_pose;
    double turning[2]; ///< w_0, w_1
};

/// Throws InputError for rods in one place.
PairFlow pair_flow(const elastic::Medium& medium, const Couplings& couplings, const Pose& pose);

enum class EquilibriumKind { orbit, parallel, in_line };
std::string to_string(EquilibriumKind kind);

using Eigenvalues = std::array<std::complex<double>, 3>;

struct PairEquilibrium {
    EquilibriumKind kind = EquilibriumKind::orbit;
    Pose pose;                    ///< in line: at the geometric mean of the two distances
    double separation[2] = {};    ///< equal; in line the two ends of the interval
    double omega = 0.0;           ///< turning rate of the pair
    Eigenvalues eigenvalues = {}; ///< of the Jacobian at `pose`, the largest real part first

    /// Whether all real parts are negative, in line but for the one along the line.
    bool stable() const;
};

/// All fixed points with least_searched <= r/xi <= most_searched: orbits, then parallel ones, by separation,
/// then intervals in line by distance.
///
/// The zeros of (a) are followed through a grid of 200 x 80 cells in (ln r, b): their crossings of the cells'
/// sides are bracketed, and between two crossings the curve is known to any accuracy. Along each piece a
/// change of sign of (b) is a fixed point; where (b) turns round within a piece, its extremum is bracketed
/// too, so two orbits next to their fold are both found. A closed curve within one cell (5 % of r, 1.1
/// degrees of b) would be missed. In line the largest real part changes sign at the ends of intervals, which
/// are bracketed on 600 distances; intervals thinner than 1.7 % of D can be missed.
std::vector<PairEquilibrium> pair_equilibria(const elastic::Medium& medium, const Couplings& couplings);

/// The two eigenvalues other than 0 of rods in line, `distance` apart, the one with the larger real part
/// first. Their sum and product are T-_h + T+_h and -D T+_y (T-_h + D T+_y + T+_h) - (1 - D^2 T+_y - D T+_h)
/// (T-_y + T+_y), of partial derivatives of T at (+-D, 0, 0).
std::array<std::complex<double>, 2> in_line_eigenvalues(const elastic::Medium& medium,
                                                        const Couplings& couplings, double distance);

/// The orbit or parallel pair to which Newton's method converges from `pose`, in the same image (omega of
/// either sign, either rod in front). Nothing if it does not, if it finds rods in line, or if its first step
/// is longer than this, in separations and rad together.
std::optional<PairEquilibrium>
equilibrium_near(const elastic::Medium& medium, const Couplings& couplings, const Pose& pose,
                 double longest_first_step = std::numeric_limits<double>::infinity());

} // namespace rodwake::rods
