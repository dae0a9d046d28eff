#pragma once
// The normal side of an impact: compression, restitution and where the impact ends. Velocities in units of
// the approach speed |v_z|, impulses in |v_z|/K_nn, work in v_z^2/K_nn.

namespace rodwake::granular {

/// Work is counted from its minimum on, not from the start: small restitution then loses no digits.
struct NormalMotion {
    double velocity = -1.0;   ///< v_z
    double compression = 0.0; ///< -W_min, up to the last time v_z rose through 0
    double regained = 0.0;    ///< W - W_min; below 0 while a compression goes deeper than before

    /// v_z rises through 0: here W is smallest, unless an earlier compression went deeper.
    void turn();
    /// Work still to be regained until W = (1 - e^2) W_min.
    double wanted(double restitution) const { return restitution * restitution * compression - regained; }
};

/// How far a piece of constant dv_z/dp was followed.
struct Piece {
    double impulse; ///< p covered
    bool ended;     ///< the impact is over
};

/// v_z = velocity + rate p for at most `length` (may be infinite if rate > 0). Closed: v_z is linear and W
/// quadratic in p.
Piece follow_straight(NormalMotion& motion, double rate, double length, double restitution);

} // namespace rodwake::granular
