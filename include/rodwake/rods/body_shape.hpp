#pragma once
// Shapes of the bodies of rods (rods/body.hpp has their motion), and what of them is legal.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::rods {

/// One rod's row of discs. Lengths in f/mu; the defaults have the proportions of the paper's brass rods.
struct BodyShape {
    std::size_t spheres = 6;     ///< discs, 1 to 1000
    double length = 1.25;        ///< end to end
    double thick_diameter = 0.3; ///< at the back
    double thin_diameter = 0.2;  ///< in front

    bool operator==(const BodyShape&) const = default;
};

/// The bodies of all rods.
struct RodBodies {
    std::vector<BodyShape> shapes; ///< one for each rod, or one for all; empty: rods are points
    double stall_overlap = 0.05;   ///< s, 1e-4 to 0.5
    double mobility_ratio = 1.0;   ///< b, > 0: mobility across the rod over that along it

    bool any() const { return !shapes.empty(); }
    const BodyShape& of(std::size_t rod) const { return shapes[shapes.size() == 1 ? 0 : rod]; }
    bool operator==(const RodBodies&) const = default;
};

/// An illegal option of a shape, and what is wrong with it.
struct BodyFault {
    std::string_view option;
    std::string message; ///< follows the option's name
};

/// Gaps in the row, a bare centre (the wake is singular there), illegal numbers; nothing: a legal shape.
std::optional<BodyFault> fault_of(const BodyShape& shape);

/// Area that the row of discs covers at most: that of its hull of length times mean diameter, (f/mu)^2.
inline double area_of(const BodyShape& shape) {
    return 0.5 * shape.length * (shape.thick_diameter + shape.thin_diameter);
}

} // namespace rodwake::rods
