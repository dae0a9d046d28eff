#pragma once
// The slip of one impact followed over the normal impulse, in units in which K_nn = 1 and v_z starts at -1
// (NormalMotion). A = K_tt/K_nn, q = K_tn/K_nn, s the unit slip direction, t = s turned by +90 degrees,
// r the slip speed. While slipping
//
//   dr/dp = g(s) = s.q - mu s.A s     r dphi/dp = h(s) = t.q - mu t.A s     dv_z/dp = 1 - mu q.s
//
// phi never crosses a root of h, so it turns monotonically towards one: to the direction in which the slip
// stops (g < 0) or in which it grows (g > 0). At a root dh/dphi = -g - mu t.A t: a root with g > 0 attracts,
// and near one that repels the slip dies faster than its deviation grows, so rounding does no harm there.

#include "fixed_order.hpp"
#include "rodwake/granular/impact.hpp"

#include <Eigen/Core>

#include <span>

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
struct SlipPiece {
    double impulse; ///< p covered
    bool ended;     ///< the impact is over
};

/// v_z = velocity + rate p for at most `length` (may be infinite if rate > 0). Closed: v_z is linear and W
/// quadratic in p.
SlipPiece follow_straight(NormalMotion& motion, double rate, double length, double restitution);

struct ContactTerms {
    ContactTerms(const Eigen::Matrix2d& a, const Eigen::Vector2d& q, const Surface& surface);

    Eigen::Matrix2d tangential; ///< A, symmetric positive definite
    Eigen::Vector2d coupling;   ///< q, with q.A^-1 q < 1
    double friction;            ///< mu > 0
    double restitution;         ///< e
    double scale;               ///< of q and mu A: what g and h are small against, and 1/tau of the path
    /// An error of v_t this large changes P by 1e-14 at most: 1e-14 of the smallest eigenvalue of A, which is
    /// at least det A/tr A. Errors do not grow along the path: friction opposes them, and two paths v(p) come
    /// closer in the norm v.A^-1 v.
    double tolerance;

    /// dv_z/dp while slipping along s.
    double normal_rate(const Eigen::Vector2d& s) const { return 1.0 - friction * coupling.dot(s); }
    /// q - mu A s = dv_t/dp while slipping along s.
    Eigen::Vector2d slip_rate(const Eigen::Vector2d& s) const {
        return coupling - friction * product(tangential, s);
    }
};

/// Where the impact has got to.
struct ImpactProgress {
    Eigen::Vector2d direction = Eigen::Vector2d::UnitX(); ///< s; without meaning when speed is 0
    double speed = 0.0;                                   ///< r
    NormalMotion normal;
    Eigen::Vector2d tangential_impulse = Eigen::Vector2d::Zero(); ///< P_t
    double normal_impulse = 0.0;                                  ///< p = P_z
    bool ended = false;
    int steps = 0; ///< Taylor steps taken
};

/// Most Taylor steps of one impact. A step covers a fixed part of the convergence radius, which is at least
/// about 1/scale and grows as the path slows down; in it r changes by a factor of e or more, or phi turns on,
/// which it does at most once around. From a slip of 1e24 down to the tolerance r falls by some 120 factors
/// of e. Some 70 steps are the most of a million hard cases (tests/granular/test_impact_closed.cpp).
inline constexpr int most_slip_steps = 1000;

/// The whole impact. Throws RunError if K is not positive definite, and after `most_slip_steps`.
void follow_impact(const ContactTerms& contact, ImpactProgress& at);

/// Several impacts side by side, each to the bit as alone.
void follow_impacts(std::span<const ContactTerms> contacts, std::span<ImpactProgress> at);

} // namespace rodwake::granular
