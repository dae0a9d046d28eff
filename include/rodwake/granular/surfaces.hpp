#pragma once
// What a bed stands between, and how things in it touch: plain options, which scenes hold as they are.

namespace rodwake::granular {

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
    /// step four times shorter. The second rules where plates are slow or still. Without gravity still plates
    /// have n = 50, whatever the beads' speed: name a step then.
    double longest_step(double gravity, double bead_radius) const;

    bool operator==(const Plates&) const = default;
};

} // namespace rodwake::granular
