// From [rods_random] to rods.

#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/body.hpp"
#include "rodwake/rods/model.hpp"
#include "rodwake/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::scene {

namespace {

/// Places so far in square cells at least `distance` wide, periodic as the square itself.
class Neighbourhood {
public:
    /// For `count` places, so many cells about.
    Neighbourhood(double side, double distance, long count)
        : side_(side),
          across_(static_cast<long>(std::min(side / distance, std::sqrt(static_cast<double>(count)) + 1.0))),
          cells_(static_cast<std::size_t>(across_ * across_)) {}

    /// Whether `clear(place)` holds for all places near enough to matter.
    template<class Clear>
    bool has_room(double x, double y, const Clear& clear) const {
        const auto is_clear = [&](const Cell& cell) { return std::ranges::all_of(cell, clear); };
        if (across_ < 3) // some would be seen twice: then all are looked at
            return std::ranges::all_of(cells_, is_clear);
        for (long i = -1; i <= 1; ++i)
            for (long j = -1; j <= 1; ++j)
                if (!is_clear(cells_[cell_of(x, i, y, j)]))
                    return false;
        return true;
    }
    void add(const rods::Pose& pose) { cells_[cell_of(pose.x, 0, pose.y, 0)].push_back(pose); }

private:
    using Cell = std::vector<rods::Pose>;

    std::size_t cell_of(double x, long right, double y, long up) const {
        const auto at = [&](double coordinate, long by) {
            const double inside = into_box(coordinate, side_) / side_;
            const long cell = std::min(across_ - 1, static_cast<long>(inside * static_cast<double>(across_)));
            return (cell + by + across_) % across_;
        };
        return static_cast<std::size_t>(at(x, right) + across_ * at(y, up));
    }

    double side_;
    long across_;
    std::vector<Cell> cells_;
};

} // namespace

double crowding(const RandomRods& random, const std::optional<Body>& body) {
    constexpr double most_covered = 0.35; // by bodies: tapered rods five diameters long jam at random at 0.5
    constexpr double quarter = 0.25 * std::numbers::pi;
    const double d = random.min_separation,
                 area = (random.shape == RandomShape::disc ? quarter : 1.0) * random.extent * random.extent;
    const double by_discs = quarter * d * d * static_cast<double>(random.count) / area;
    const double by_bodies = body ? rods::area_of(*body) * static_cast<double>(random.count) / area : 0.0;
    return std::max(by_discs, by_bodies * most_crowding / most_covered);
}

std::string region_of(const RandomRods& random) {
    return fmt::format("{} {}", random.shape == RandomShape::disc ? "disc of diameter" : "square of side",
                       random.extent);
}

std::vector<Rod> random_rods(const RandomRods& random, const std::optional<Body>& body) {
    constexpr int tries = 100'000;                  // at most_crowding one in ten fits
    if (!(crowding(random, body) <= most_crowding)) // reported
        return {};
    if (body && rods::fault_of(*body)) // likewise
        return {};
    RandomStream stream(static_cast<std::uint64_t>(random.seed));
    const bool disc = random.shape == RandomShape::disc;
    const double half = 0.5 * random.extent, apart = std::max(random.min_separation, 1e-6 * random.extent);
    rods::RodBodies bodies;
    if (body)
        bodies.shapes = {*body};
    const rods::BodyForces pair(bodies, 2, std::nullopt);
    Neighbourhood placed(random.extent, std::max(apart, pair.farthest_touch()), random.count);
    std::vector<Rod> rods;
    for (long k = 0; k < random.count; ++k)
        for (int i = 0; i < tries; ++i) {
            rods::Pose pose{stream.uniform(-half, half), stream.uniform(-half, half), 0.0};
            if (disc && !(std::hypot(pose.x, pose.y) < half))
                continue;
            if (body) // its heading says whether there is room
                pose.heading = random.heading + stream.uniform(-random.spread, random.spread);
            const auto clear = [&](const rods::Pose& other) {
                double x = pose.x - other.x, y = pose.y - other.y;
                if (!disc)
                    x = nearest_image(x, random.extent), y = nearest_image(y, random.extent);
                if (std::hypot(x, y) < apart)
                    return false;
                return !body || pair.contact(rods::to_state(std::array<rods::Pose, 2>{
                                                 {{x, y, pose.heading}, {0.0, 0.0, other.heading}}}),
                                             0, 1)
                                        .gap > 0.0;
            };
            if (!placed.has_room(pose.x, pose.y, clear))
                continue;
            if (!body)
                pose.heading = random.heading + stream.uniform(-random.spread, random.spread);
            placed.add(pose);
            rods.push_back({{pose.x, pose.y}, pose.heading, {}});
            break;
        }
    return rods;
}

} // namespace rodwake::scene
