#pragma once
// A vertical wall around a bed: the dish of an experiment. Plain numbers, which scenes hold as they are.

#include "rodwake/core/periodic.hpp"
#include "rodwake/granular/surfaces.hpp"

namespace rodwake::granular {

enum class ContainerKind { circle, rectangle };

/// The circle that touches all sides of the rectangle [0, x] x [0, y], x = y, or this rectangle itself.
struct Container {
    ContainerKind kind = ContainerKind::circle;
    PeriodicBox sides; ///< x and y of that rectangle, m
    Surface beads{0.2, 0.3}, rods{0.03, 0.1};

    double radius() const { return 0.5 * sides.x; } ///< of a circle, m
    double area() const;
    /// A bed with a wall is simulated in a periodic box of twice these sides: the nearest image of a
    /// difference between two bodies is then the difference itself, whatever asks for it.
    PeriodicBox box() const { return {2.0 * sides.x, 2.0 * sides.y}; }

    bool operator==(const Container&) const = default;
};

} // namespace rodwake::granular
