#pragma once
// Rods with bodies: rigid rows of discs that push each other apart without inertia.
//
// Disc k of rod a, k = 0 ... n - 1 from the back, has its centre at R_a + s_k n_a and the radius r_k:
//
//   r_k = r_0 + (r_{n-1} - r_0) k/(n - 1),   r_0 = thick_diameter/2, r_{n-1} = thin_diameter/2
//   s_k = (k/(n - 1) - 1/2) l,               l = length - r_0 - r_{n-1};   n = 1: s = 0
//
// Discs k and m of two rods whose centres are d apart overlap by delta = 1 - d/(r_k + r_m). Where that is
// positive each gets the force K delta^(3/2) along the line of centres, away from the other. The friction of
// the substrate answers: with F the sum of the forces on the discs of rod a and m = z x n,
//
//   R_a'     = n_a + M [ (F.n_a) n_a + b (F.m_a) m_a ]
//   theta_a' = (wakes, rows) + (12 M/length^2) sum over k of s_k z.(n_a x F_k)
//
// Reduced units: lengths f/mu, times f/(mu v0). Only K M counts; K M = s^(-3/2) with s the stall_overlap: a
// rod that walks head on against a fixed disc stops at delta = s. The factor 12/length^2 is that of uniform
// friction along a line; it is a convention and does not change with b.
//
// Domain: delta <= 1, and a force of at most K: discs driven harder pass through each other. Discs with one
// centre have no direction and exert no force. The rates are continuous, their second derivatives are not:
// methods of an order above 2 reject steps at the moment of touch. The wake of a rod is that of a walk at
// v0, however it is pushed: the limit of quasi-static wakes.
//
// In a periodic box rods touch the nearest images of others; its sides must exceed twice the longest rod.
// Hard rods are the limit s -> 0; rates get stiffer as s^(-3/2).

#include "rodwake/integrate/ode.hpp"
#include "rodwake/rods/body_shape.hpp"
#include "rodwake/rods/separation.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::rods {

/// Two rods whose discs are `gap` apart, below 0 if they overlap; `overlap` is the largest delta of their
/// discs, of discs that do not touch as far below 0 as they are apart.
struct BodyContact {
    std::size_t first, second;
    double gap, overlap;
};

/// The forces between the bodies of given rods. Thread-safe.
class BodyForces {
public:
    BodyForces() = default; ///< rods without bodies
    /// Throws InputError for illegal shapes, a wrong number of them, or a box too small.
    BodyForces(const RodBodies& bodies, std::size_t rods, Box box);

    bool any() const { return !rows_.empty(); }
    /// Adds the rates by contacts; state and rates as in model.hpp.
    void add_rates(integrate::State y, std::span<double> ydot) const;
    /// Adds their derivatives by the state.
    void add_jacobian(integrate::State y, Eigen::Ref<Eigen::MatrixXd> jacobian) const;

    /// Pairs whose gap is below `reach`, in increasing order.
    std::vector<BodyContact> contacts(integrate::State y, double reach) const;
    /// The pair with the smallest gap, the first of equals; needs two rods or more.
    BodyContact closest(integrate::State y) const;
    /// The contact of two rods, however far apart.
    BodyContact contact(integrate::State y, std::size_t a, std::size_t b) const;
    /// Longest step after which the right-hand side still sees the touch of two rods that are apart now:
    /// (gap/2 + share r)/v for the nearest of them, r being the smallest radius and v = max(|n_a - n_b|, 1/2)
    /// their relative speed. Discs that touch and part within it, unseen, shift a rod by some 1e-4 share^4.
    double step_limit(integrate::State y, double share) const;
    /// The fastest rate at which the contacts of this state relax, at least 0: by Gershgorin's circles.
    double relaxation_rate(integrate::State y) const;
    /// Rods touch while a delta is above this, a hundredth of stall_overlap: rods that slid apart keep a
    /// delta > 0 that decays as t^(-2).
    double touching_overlap() const { return 0.01 * bodies_.stall_overlap; }
    /// Centres of two rods that touch are nearer than this.
    double farthest_touch() const { return 2.0 * reach_; }

private:
    struct BodyDisc {
        double along, radius;
    };
    /// Discs from the back to the front; `half` of the length between the outermost centres, their spacing,
    /// and the change of the radii along it.
    struct DiscRow {
        std::vector<BodyDisc> discs;
        double half, spacing, slope;
        double thickest() const { return discs.front().radius; }
    };
    struct Touch;  ///< two discs that overlap, with their force
    struct Facing; ///< two rods, one as the other sees it
    template<class See>
    void each_near(integrate::State y, double range, See&& see) const;
    template<class Use>
    void each_touch(integrate::State y, Use&& use) const;
    const DiscRow& row_of(std::size_t rod) const;
    Facing facing(integrate::State y, std::size_t a, std::size_t b, Offset d) const;
    BodyContact contact(std::size_t a, std::size_t b, const Facing& pair) const;

    RodBodies bodies_;
    Box box_;
    std::vector<DiscRow> rows_; ///< of each shape
    double strength_ = 0.0;     ///< K M
    double thinnest_ = 0.0;     ///< smallest radius of any disc
    double reach_ = 0.0;        ///< farthest point of any body from its centre
};

} // namespace rodwake::rods
