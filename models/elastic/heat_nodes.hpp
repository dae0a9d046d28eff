#pragma once
// A wake as drifting heat. A rod that has always walked straight at speed 1 (the unit; xi = 1, too) pushed
// at r + n t a time t ago, and what it did there has spread since: from Eq. 1 of docs/physics.md,
//
//   U(r) = int_0^inf dt [ n g_T + grad (n.grad) Phi ](r + n t, t),   g_i = e^(-r^2/(4 D_i t))/(4 pi D_i t)
//   lap Phi = g_L - g_T,   D_T = 1,   D_L = 1 + eta
//
// in f/mu. The trapezoidal rule in s = sqrt(t) has an error that falls off with the distance r faster than
// exp(-(r/h)^(2/3)) of a step h, since g vanishes with all derivatives at s = 0: beyond some distance a wake
// is a sum of Gaussians that all rods share but for place and direction. With rho = r^2, a = 1/(4 t), b =
// a/(1 + eta),
//
//   Phi' = (e^(-a rho) - e^(-b rho))/(4 pi rho),   Phi'' = ((g_L - g_T)/4 - Phi')/rho,
//   Phi''' = ((2 a g_T - 2 b g_L)/8 - 2 Phi'')/rho
//
// derivatives by rho; for a rho < 0.1 by their series.

#include "wake_kernel.hpp"

#include <array>
#include <span>
#include <vector>

namespace rodwake::elastic {

struct HeatNode {
    double time, a, b, weight;
    std::array<double, 8> series{}; ///< (-1)^n (a^n - b^n)/(4 pi n!), n from 1
};

/// At s = sqrt(time), which stands for `step` of s.
HeatNode heat_node(double s, double step, double eta);

/// Targets of which all lanes have a place.
inline constexpr std::size_t heat_lanes = 8;

/// Takes from the sums what a node of one rod's wake gives at heat_lanes targets. Lengths in xi.
void subtract_heat(const HeatNode& node, const KernelSource& source, const KernelTargets& targets);

// Near pairs.

/// What is taken off of pairs up to a reach: the first nodes one by one and all others as polynomials in the
/// rod's frame, in xi: part = (y) sum c x^i y^(2 j), i + 2 j <= degree, row by row of j; x and y in reaches.
struct NearHeat {
    static constexpr std::size_t degree = 16, terms = (degree / 2 + 1) * (degree / 2 + 1);

    double reach;
    double cutoff; ///< Gaussians below e^-cutoff may be left out
    std::vector<HeatNode> nodes;
    /// trace, eps_xx - eps_yy, 2 eps_xy, lap U, grad div U; the third, fifth and last with the factor y
    std::array<std::array<double, terms>, all_parts> part{};
    std::array<double, all_parts> own{}; ///< at the rod itself
    static constexpr std::array<bool, all_parts> odd{false, false, true, false, true, false, true};
};

/// Sources near a target, filled up to whole vectors with some of weight 0.
struct NearSources {
    std::vector<double> x, y, cosine, sine, weight;

    void clear();
    void add(const KernelSource& source, double weight);
};

/// Adds to sums[k] at (x, y) what the sources give, less what the heat gives. Lengths in the unit of the
/// medium's xi.
void add_near(const KernelMedium& medium, const Field& field, const NearHeat& heat,
              const NearSources& sources, double x, double y, bool polar, std::span<double> sums);

} // namespace rodwake::elastic
