#pragma once
// Which beads are far from every rod.

#include "rodwake/measure/frame.hpp"

#include "rod_view.hpp"

#include <algorithm>
#include <vector>

namespace rodwake::measure {

class FarField {
public:
    FarField(const Frame& frame, double box, double from) : from2_(from * from) {
        for (const RodPlace& rod : frame.rods)
            rods_.emplace_back(rod, box);
    }
    bool has(double x, double y) const {
        return std::ranges::all_of(rods_, [&](const RodView& rod) { return rod.distance2(x, y) > from2_; });
    }

private:
    double from2_;
    std::vector<RodView> rods_;
};

} // namespace rodwake::measure
