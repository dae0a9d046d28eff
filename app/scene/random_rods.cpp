// From [rods_random] to rods.

#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/scene/scene.hpp"

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
        : side_(side), distance_(distance),
          across_(static_cast<long>(std::min(side / distance, std::sqrt(static_cast<double>(count)) + 1.0))),
          cells_(static_cast<std::size_t>(across_ * across_)) {}

    bool has_room(double x, double y) const {
        const long reach = across_ < 3 ? 0 : 1; // fewer would be seen twice: then all are looked at
        if (reach == 0)
            return std::ranges::all_of(cells_, [&](const Cell& cell) { return is_clear(cell, x, y); });
        for (long i = -1; i <= 1; ++i)
            for (long j = -1; j <= 1; ++j)
                if (!is_clear(cells_[cell_of(x, i, y, j)], x, y))
                    return false;
        return true;
    }
    void add(double x, double y) { cells_[cell_of(x, 0, y, 0)].push_back({x, y}); }

private:
    using Cell = std::vector<std::array<double, 2>>;

    std::size_t cell_of(double x, long right, double y, long up) const {
        const auto at = [&](double coordinate, long by) {
            const double inside = into_box(coordinate, side_) / side_;
            const long cell = std::min(across_ - 1, static_cast<long>(inside * static_cast<double>(across_)));
            return (cell + by + across_) % across_;
        };
        return static_cast<std::size_t>(at(x, right) + across_ * at(y, up));
    }
    bool is_clear(const Cell& cell, double x, double y) const {
        return std::ranges::none_of(cell, [&](const auto& other) {
            return nearest_distance(x - other[0], y - other[1], side_) < distance_;
        });
    }

    double side_, distance_;
    long across_;
    std::vector<Cell> cells_;
};

} // namespace

double crowding(const RandomRods& random) {
    const double d = random.min_separation;
    return 0.25 * std::numbers::pi * d * d * static_cast<double>(random.count) /
           (random.extent * random.extent);
}

std::vector<Rod> random_rods(const RandomRods& random) {
    constexpr int tries = 100'000;            // at most_crowding one in ten fits
    if (!(crowding(random) <= most_crowding)) // reported
        return {};
    RandomStream stream(static_cast<std::uint64_t>(random.seed));
    const double half = 0.5 * random.extent, apart = std::max(random.min_separation, 1e-6 * random.extent);
    Neighbourhood placed(random.extent, apart, random.count);
    std::vector<Rod> rods;
    for (long k = 0; k < random.count; ++k)
        for (int i = 0; i < tries; ++i) {
            const double x = stream.uniform(-half, half), y = stream.uniform(-half, half);
            if (!placed.has_room(x, y))
                continue;
            placed.add(x, y);
            rods.push_back({{x, y}, random.heading + stream.uniform(-random.spread, random.spread)});
            break;
        }
    return rods;
}

} // namespace rodwake::scene
