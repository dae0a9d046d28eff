#pragma once
// The two equations that are left of a pair's fixed point (rods/pair_equilibria.hpp), in lengths of xi.

#include "rodwake/elastic/field.hpp"
#include "rodwake/rods/pair_equilibria.hpp"

#include <limits>

namespace rodwake::rods {

/// A pair in lengths xi and times xi/v0: there kappa is the same number, and polar couplings are times
/// f/(mu xi) = alpha.
struct ScaledPair {
    elastic::Field field; ///< xi = 1
    Couplings couplings;
    double xi;

    ScaledPair(const elastic::Medium& medium, const Couplings& unscaled);
};

/// T(x, y, h), and its derivatives.
double turning(const ScaledPair& pair, double x, double y, double h);
struct TurningRate turning_derivatives(const ScaledPair& pair, double x, double y, double h);

PairFlow flow_at(const ScaledPair& pair, const Pose& pose);
/// Its rates alone, for half the cost.
Eigen::Vector3d rates_at(const ScaledPair& pair, const Pose& pose);
/// Newton's method in three unknowns from a pose in units of xi, and what it finds there, in those of f/mu.
std::optional<PairEquilibrium> newton(const ScaledPair& pair, Pose pose,
                                      double longest_first_step = std::numeric_limits<double>::infinity());
/// What is at this pose, in units of f/mu.
PairEquilibrium described(const ScaledPair& pair, const Pose& pose);

/// Orbits, with h = 2 b, or parallel rods, with h = 0.
enum class Family { orbit, parallel };

/// Where two rods are: u = ln(r/xi), and b.
struct Reduced {
    double u, b;
};
Pose pose_of(Family family, Reduced at);

/// r (T+ + T-), and r (T+ - T-)/2 - 2 sin b (parallel: without the sine), with the derivatives by u and b.
struct ReducedEquations {
    Eigen::Vector2d values;
    Eigen::Matrix2d by_place;
};
ReducedEquations reduced_equations(const ScaledPair& pair, Family family, Reduced at);
/// The first of them alone, which is cheaper.
double unequal_turning(const ScaledPair& pair, Family family, Reduced at);

} // namespace rodwake::rods
