#pragma once
// One impact of two rigid bodies at one point: Stronge's law with Coulomb friction and energetic restitution.
//
// Contact frame: z along the normal, v the velocity of the contact point of body 1 relative to body 2 before
// the impact (v_z < 0: approaching), K the symmetric inverse mass of the pair at the point, 1/kg:
//
//   dv = K dP,   normal impulse p = P_z from 0 on,   friction coefficient mu, restitution e
//   while slipping along s = v_t/|v_t|:  dP/dp = (-mu s, 1)
//   at zero slip: stick if |K_tt^-1 K_tn| <= mu (dP_t/dp = -K_tt^-1 K_tn), else slip goes on along the one
//   s for which K_tn - mu K_tt s is parallel to s and |v_t| grows
//   compression ends where v_z = 0; with W(p) = integral of v_z dp the impact ends where W = (1 - e^2) W_min
//
// (W. J. Stronge, Impact Mechanics, 2000, chs. 3-5; docs/impact_law.md.) Energy never grows for 0 <= e <= 1.
// Units: any consistent ones; nothing here depends on scale.

#include "rodwake/granular/surfaces.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace rodwake::granular {

struct Impact {
    Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  ///< P on body 1 (body 2 gets -P)
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< w = v + K P after the impact
};

/// The law for any symmetric positive definite K (normal and tangential motion coupled). Straight pieces of
/// the slip path are closed; curved ones are followed by a Taylor series of bounded remainder. Error below
/// 1e-12 |P| for condition numbers of K up to 1e3 (a rod's is below 1e2), 1e-13 |P| times it for larger ones.
/// No impulse if v_z >= 0. Throws RunError if the path has no end, which needs a K that is not positive
/// definite to rounding.
Impact stronge_impact(const Eigen::Matrix3d& inverse_mass, const Eigen::Vector3d& velocity,
                      const Surface& surface);

struct ImpactCase {
    Eigen::Matrix3d inverse_mass; ///< K
    Eigen::Vector3d velocity;     ///< v
    Surface surface;
};

/// stronge_impact of each, to the bit. Slips that turn are followed side by side, in half of the time.
void stronge_impacts(std::span<const ImpactCase> cases, std::vector<Impact>& impacts);

/// The law where K = diag(k_t, k_t, k_n): spheres with spheres and plates. Slip keeps its direction and stops
/// at most once, so one closed form is exact.
Impact uncoupled_impact(double k_t, double k_n, const Eigen::Vector3d& velocity, const Surface& surface);

} // namespace rodwake::granular
