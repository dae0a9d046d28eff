#include "plan_view.hpp"

#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::granular {

std::vector<Disc> rod_discs(const RodSpec& rod, const Clump& clump) {
    const double c = std::cos(rod.heading), s = std::sin(rod.heading);
    std::vector<Disc> discs;
    for (std::size_t k = 0; k < clump.offset.size(); ++k)
        discs.push_back({rod.position.x() + c * clump.offset[k], rod.position.y() + s * clump.offset[k],
                         clump.radius[k]});
    return discs;
}

double overlap(const std::vector<Disc>& first, const std::vector<Disc>& second, const PeriodicBox& box) {
    double deepest = -std::numeric_limits<double>::infinity();
    for (const Disc& a : first)
        for (const Disc& b : second) {
            const double dx = nearest_image_rounded(a.x - b.x, box.x),
                         dy = nearest_image_rounded(a.y - b.y, box.y);
            deepest = std::max(deepest, a.radius + b.radius - std::hypot(dx, dy));
        }
    return deepest;
}

} // namespace rodwake::granular
