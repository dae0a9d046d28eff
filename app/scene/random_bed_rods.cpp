// From [granular.rods_random] to rods.

#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/core/repeatable_math.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/granular/shape.hpp"
#include "rodwake/scene/granular.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::scene {

namespace {

/// A rod in plan view.
struct PlanRod {
    double x, y, ahead_x, ahead_y;
};

/// Smallest gap between the spheres of two rods of this shape, nearest images in a periodic bed, m; of rods
/// that are surely further apart than `enough` a lower bound.
double gap_between(const PlanRod& other, const PlanRod& two, const granular::Clump& clump,
                   const PeriodicBox& box, double enough) {
    const double x = nearest_image_rounded(other.x - two.x, box.x),
                 y = nearest_image_rounded(other.y - two.y, box.y);
    double least = std::sqrt(x * x + y * y) - 2.0 * clump.reach();
    if (least > enough)
        return least;
    least = HUGE_VAL;
    for (std::size_t i = 0; i < clump.offset.size(); ++i)
        for (std::size_t j = 0; j < clump.offset.size(); ++j) {
            const double dx = nearest_image_rounded(other.x + clump.offset[i] * other.ahead_x - two.x -
                                                        clump.offset[j] * two.ahead_x,
                                                    box.x),
                         dy = nearest_image_rounded(other.y + clump.offset[i] * other.ahead_y - two.y -
                                                        clump.offset[j] * two.ahead_y,
                                                    box.y);
            least = std::min(least, std::sqrt(dx * dx + dy * dy) - clump.radius[i] - clump.radius[j]);
        }
    return least;
}

/// Smallest gap between a rod and the wall of the container, m.
double gap_to_wall(const PlanRod& rod, const granular::Clump& clump, granular::ContainerKind kind,
                   const std::array<double, 2>& sides) {
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < clump.offset.size(); ++i) {
        const double x = rod.x + clump.offset[i] * rod.ahead_x - 0.5 * sides[0],
                     y = rod.y + clump.offset[i] * rod.ahead_y - 0.5 * sides[1];
        const double gap = kind == granular::ContainerKind::circle
                               ? 0.5 * sides[0] - std::sqrt(x * x + y * y)
                               : std::min(0.5 * sides[0] - std::abs(x), 0.5 * sides[1] - std::abs(y));
        least = std::min(least, gap - clump.radius[i]);
    }
    return least;
}

} // namespace

granular::RodShape default_shape(granular::RodKind kind) {
    granular::RodShape shape;
    if (kind == granular::RodKind::apolar) {
        shape.spheres = 13;
        shape.thick_diameter = 0.95e-3;
    }
    shape.kind = kind;
    return shape;
}

std::vector<GranularRod> random_bed_rods(const Granular& bed) {
    constexpr int tries = 20'000;
    const RandomBedRods& random = *bed.rods_random;
    // Rods lie in the rectangle [0, x] x [0, y], if the scene has one yet.
    std::array<double, 2> sides{bed.box.x, bed.box.y};
    if (bed.container && bed.container->kind == granular::ContainerKind::circle)
        sides.fill(2.0 * bed.container->radius.value_or(0.0));
    else if (bed.container && bed.container->sides.size() == 2)
        sides = {bed.container->sides[0], bed.container->sides[1]};
    if (bed.box.fit ||
        !std::ranges::all_of(sides, [](double side) { return side > 0.0 && std::isfinite(side); }))
        return {};
    const granular::RodShape shape = default_shape(random.kind);
    const granular::Clump clump = granular::make_clump(shape);
    // In a container images are so far away that they are none.
    const PeriodicBox box{(bed.container ? 3.0 : 1.0) * sides[0], (bed.container ? 3.0 : 1.0) * sides[1]};
    const double apart = std::max(random.min_separation, 1e-6 * bed.bead_radius);
    RandomStream stream(static_cast<std::uint64_t>(random.seed));
    std::vector<PlanRod> placed;
    std::vector<GranularRod> rods;
    for (long k = 0; k < random.count; ++k) {
        bool found = false;
        for (int i = 0; i < tries && !found; ++i) {
            const double x = stream.uniform(0.0, sides[0]), y = stream.uniform(0.0, sides[1]),
                         heading = random.heading + stream.uniform(-random.spread, random.spread);
            const auto [sine, cosine] = repeatable::sin_cos(heading);
            const PlanRod row{x, y, cosine, sine};
            found = (!bed.container || gap_to_wall(row, clump, bed.container->kind, sides) > apart) &&
                    std::ranges::all_of(placed, [&](const PlanRod& other) {
                        return gap_between(row, other, clump, box, apart) > apart;
                    });
            if (!found)
                continue;
            placed.push_back(row);
            rods.push_back({shape, {x, y}, heading, {}});
        }
        if (!found)
            break;
    }
    return rods;
}

} // namespace rodwake::scene
