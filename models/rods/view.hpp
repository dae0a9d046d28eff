#pragma once
// One rod as another sees it.

#include "interaction.hpp"

#include "rodwake/integrate/ode.hpp"

#include <cmath>

namespace rodwake::rods {

struct Direction {
    double cosine, sine;
};

inline Direction direction(integrate::State y, std::size_t rod) {
    return {std::cos(y[3 * rod + 2]), std::sin(y[3 * rod + 2])};
}

/// Rod a as rod b sees it.
struct View {
    double x, y; ///< place of a in b's frame
    RelativeHeading heading;
};

inline View view(integrate::State y, std::size_t a, std::size_t b, Direction na, Direction nb) {
    const double dx = y[3 * a] - y[3 * b], dy = y[3 * a + 1] - y[3 * b + 1];
    return {nb.cosine * dx + nb.sine * dy,
            nb.cosine * dy - nb.sine * dx,
            {na.cosine * nb.cosine + na.sine * nb.sine, na.sine * nb.cosine - na.cosine * nb.sine}};
}

} // namespace rodwake::rods
