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
// (W. J. Stronge, Impact Mechanics, 2000, chs. 3-5; docs/granular.md.) Energy never grows for 0 <= e <= 1.
// Units: any consistent ones; nothing here depends on scale.

#include <Eigen/Core>

namespace rodwake::granular {

// What a bed stands between, and how things in it touch: plain options, which scenes hold as they are.

/// Coulomb friction and energetic restitution of a pair of kinds.
struct Surface {
    double friction = 0.0;    ///< mu >= 0
    double restitution = 0.0; ///< e, 0 <= e <= 1

    bool operator==(const Surface&) const = default;
};

/// Coefficients of each pair of kinds. A plate never meets a plate.
struct ContactTable {
    Surface bead_bead{0.05, 0.3}, bead_rod{0.05, 0.3}, rod_rod{0.05, 0.3};
    Surface bead_plate{0.2, 0.3}, rod_plate{0.03, 0.1};

    bool operator==(const ContactTable&) const = default;
};

/// Floor z = A cos(2 pi f t), lid the same + w, Gamma = A (2 pi f)^2/g.
struct Plates {
    double gap = 1.2e-3;      ///< w, m
    double frequency = 200.0; ///< f, Hz
    double gamma = 7.0;       ///< Gamma; 0: static plates

    /// A, m.
    double amplitude(double gravity) const;
    /// Time step that follows a bed on these plates, s: 1/(n f) with the least integer n >= 50 for which, in
    /// one step, the plates at their fastest (Gamma g/(2 pi f)) move by at most 0.0137 bead radii and a body
    /// falls from rest by at most 2e-4 of them. The first limit is what Gamma = 7, 200 Hz and a = 0.4 mm have
    /// at 1e-4 s: there T_xy and T_z at phi_b = 0.80 differ by 0.1 +- 0.2 % and 0.1 +- 0.1 % from those of a
    /// step four times shorter. The second rules where plates are slow or still.
    double longest_step(double gravity, double bead_radius) const;

    bool operator==(const Plates&) const = default;
};

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

/// The law where K = diag(k_t, k_t, k_n): spheres with spheres and plates. Slip keeps its direction and stops
/// at most once, so one closed form is exact.
Impact uncoupled_impact(double k_t, double k_n, const Eigen::Vector3d& velocity, const Surface& surface);

} // namespace rodwake::granular
