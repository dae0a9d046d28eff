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

    bool operator==(const Plates&) const = default;
};

} // namespace rodwake::granular
