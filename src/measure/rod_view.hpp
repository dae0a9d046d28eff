#pragma once
// Beads as a rod sees them, for inner loops: seen_from (rod_grid.hpp) with the rod's sine and cosine worked
// out once, and only for places in [0, box).

#include "rodwake/measure/rod_grid.hpp"

#include <cmath>

namespace rodwake::measure {

/// To the nearest image, of a difference in [-3 box/2, 3 box/2].
inline double nearest_step(double difference, double box) {
    const double half = 0.5 * box;
    return difference > half ? difference - box : difference < -half ? difference + box : difference;
}

class RodView {
public:
    RodView(const RodPlace& rod, double box)
        : box_(box), x_(rod.x - box * std::floor(rod.x / box)), y_(rod.y - box * std::floor(rod.y / box)),
          cosine_(std::cos(rod.heading)), sine_(std::sin(rod.heading)) {}

    Seen at(double x, double y) const {
        return turned(nearest_step(x - x_, box_), nearest_step(y - y_, box_));
    }
    /// A vector's components along and across the rod.
    Seen turned(double x, double y) const { return {cosine_ * x + sine_ * y, -sine_ * x + cosine_ * y}; }
    double distance2(double x, double y) const {
        const double dx = nearest_step(x - x_, box_), dy = nearest_step(y - y_, box_);
        return dx * dx + dy * dy;
    }

private:
    double box_, x_, y_, cosine_, sine_;
};

} // namespace rodwake::measure
