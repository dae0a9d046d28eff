#pragma once
// A wake as drifting heat. A rod that has always walked straight at speed 1 (the unit; xi = 1, too) pushed
// at r + n t a time t ago, and what it did there has spread since: from Eq. 1 of docs/theory.md,
//
//   U(r) = int_0^inf dt [ n g_T + grad (g_T - D_L g_L) ](r + n t, t),   g_i = e^(-r^2/(4 D_i t))/(4 pi D_i t)
//   D_T = 1,   D_L = 1 + eta
//
// in f/mu. The trapezoidal rule in s = sqrt(t) has an error that falls off with the distance r faster than
// exp(-(r/h)^(2/3)) of a step h, since g vanishes with all derivatives at s = 0: beyond some distance a wake
// is a sum of Gaussians that all rods share but for place and direction.
//
// Near a rod along x such a sum is of the form of the exact field (kernel_inl.hpp). In lengths of 2 xi,
//
//   g_i = e^(-a X) A(s)/(2 pi D),   a = 1/D,   A(s) = sum_k w_k/(2 t_k) e^(-a t_k/4 - a s^2/t_k),
//
// so that all it takes is A and its derivatives, functions of the distance alone: polynomials in sqrt(s).

#include "wake_kernel.hpp"

#include <array>
#include <span>
#include <vector>

namespace rodwake::elastic {

struct HeatNode {
    double time, weight;
};

/// e^(a s) times A, A'/s, s^2 Q with Q = (A'/s)'/s, and (A'' + A'/s)', of shear and of longitudinal motion.
using WakeFunctions = std::array<double, 8>;

/// Of the exact field, at a distance s > 0.
WakeFunctions exact_functions(double eta, double s);
/// Takes a node's off.
void take_node(const HeatNode& node, double eta, double s, WakeFunctions& f);

/// Targets that go together.
inline constexpr std::size_t heat_lanes = 8;

/// What such functions give in these directions from a rod along x.
void parts_at(const WakeFunctions& f, const Field& field, double s, const double* cosine, const double* sine,
              double (*parts)[heat_lanes]);

// Near pairs.

/// What pairs within a reach lack: functions of the exact field less those of the nodes, in pieces of
/// sqrt(r/reach), by powers of the place in a piece, -1 to 1. In the first piece, where the exact ones are
/// singular, of the nodes alone.
struct NearHeat {
    static constexpr std::size_t functions = 8, pieces = 8, most_terms = 20;
    static constexpr double first_end = 0.25; ///< of the first piece; the others are alike
    using Coefficients = std::array<std::array<double, pieces>, functions>;

    double reach; ///< in xi
    std::vector<Coefficients> powers;
    double own[all_parts][heat_lanes] = {}; ///< what the rod itself lacks if it is along x, in each lane
};

/// Of nodes whose polynomials may be wrong by `error`; all of a NearHeat but for `own`. Without powers: no
/// number of terms is that good.
NearHeat near_heat(std::span<const HeatNode> nodes, double eta, double reach, double error, bool polar);

/// Sources, filled up to whole vectors with some that are not meant.
struct NearSources {
    std::vector<double> x, y, cosine, sine, number;
    std::size_t count = 0; ///< of those that are meant

    /// Room for so many, and a vector beyond.
    void reserve(std::size_t most) {
        if (x.size() < most + heat_lanes)
            for (auto* item : {&x, &y, &cosine, &sine, &number})
                item->resize(most + heat_lanes);
    }
    void add(const KernelSource& source, double as) {
        x[count] = source.x;
        y[count] = source.y;
        cosine[count] = source.cosine;
        sine[count] = source.sine;
        number[count++] = as;
    }
    void take(const NearSources& from, std::size_t k) {
        add({from.x[k], from.y[k], from.cosine[k], from.sine[k]}, from.number[k]);
    }
};

/// Those of `from` that are within a distance of (x, y), but for the one with that number.
void find_near(const NearSources& from, double x, double y, double distance, double number, NearSources& to);

/// Adds to sums[k] at (x, y) what sources within the reach give, less what the heat gives. Lengths in the
/// unit of the medium's xi.
void add_near(const KernelMedium& medium, const Field& field, const NearHeat& heat,
              const NearSources& sources, double x, double y, bool polar, std::span<double> sums);

} // namespace rodwake::elastic
