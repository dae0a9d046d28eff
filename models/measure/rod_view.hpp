#pragma once
// Beads as a rod sees them, for inner loops: relative_position (rod_grid.hpp) with the rod's sine and cosine
// worked out once, and only for places in the box.

#include "rodwake/core/periodic.hpp"
#include "rodwake/measure/rod_grid.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rodwake::measure {

class RodView {
public:
    RodView(const RodPosition& rod, const PeriodicBox& box)
        : box_(box), x_(into_box(rod.x, box.x)), y_(into_box(rod.y, box.y)), cosine_(std::cos(rod.heading)),
          sine_(std::sin(rod.heading)) {}

    RelativePosition at(double x, double y) const {
        return turned(nearest_image_once(x - x_, box_.x), nearest_image_once(y - y_, box_.y));
    }
    /// A vector's components along and across the rod.
    RelativePosition turned(double x, double y) const {
        return {cosine_ * x + sine_ * y, -sine_ * x + cosine_ * y};
    }
    double distance2(double x, double y) const {
        const double dx = nearest_image_once(x - x_, box_.x), dy = nearest_image_once(y - y_, box_.y);
        return dx * dx + dy * dy;
    }

private:
    PeriodicBox box_;
    double x_, y_, cosine_, sine_;
};

// Which beads are far from every rod that is seen, and from the force.

class FarField {
public:
    FarField(const Frame& frame, const Layout& layout, double from) : from2_(from * from) {
        for (const RodPosition& rod : frame.rods)
            if (rod.seen())
                rods_.emplace_back(rod, image_box(layout));
        if (layout.force)
            rods_.emplace_back(place_of(0, layout, frame), layout.box);
    }
    bool has(double x, double y) const {
        return std::ranges::all_of(rods_, [&](const RodView& rod) { return rod.distance2(x, y) > from2_; });
    }

private:
    double from2_;
    std::vector<RodView> rods_;
};

} // namespace rodwake::measure
