#pragma once
// Sizes of the beads of a bed: one, several kinds mixed, and a spread of the radii about those. Plain
// options, which scenes hold as they are.

#include <cstddef>
#include <vector>

namespace rodwake::granular {

inline constexpr std::size_t most_bead_kinds = 16;

struct BeadKind {
    double radius = 0.0; ///< m
    double share = 1.0;  ///< of the number of beads, over the sum of the shares of all kinds

    bool operator==(const BeadKind&) const = default;
};

/// Radius of a bead: that of its kind times 1 + spread x, x normal and cut at two deviations, times a factor
/// near 1 that is the same for all beads of a bed (bead_sizes in problem.hpp).
struct BeadMix {
    double radius = 0.4e-3;           ///< of all beads, m, if there are no kinds
    std::vector<BeadKind> kinds = {}; ///< empty: one
    double spread = 0.0;              ///< standard deviation of the radii of a kind, over their mean

    /// All kinds have the same radius, a spread aside.
    bool one_size() const;
    /// All beads have the same radius.
    bool equal() const { return spread == 0.0 && one_size(); }
    /// Bounds of the radii, the common factor aside, m.
    double smallest() const;
    double largest() const;
    /// Root of the mean square of the kinds' radii by their shares, m: N discs of this radius cover what the
    /// beads cover.
    double root_mean_square() const;
    /// Number of the kind whose radius is nearest, of equal ones the first; 0 if there are no kinds.
    std::size_t nearest(double to_radius) const;
    /// How many of `beads` are of each kind: shares by the method of largest remainders, of equal ones the
    /// first. One number if there are no kinds.
    std::vector<std::size_t> counts(std::size_t beads) const;

    bool operator==(const BeadMix&) const = default;
};

} // namespace rodwake::granular
