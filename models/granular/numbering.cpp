#include "numbering.hpp"

#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace rodwake::granular {

namespace {

constexpr double beads_per_tile = 64.0;

/// The low 16 bits with a zero after each.
std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 8) & 0x00ff00ffu;
    bits = (bits | bits << 4) & 0x0f0f0f0fu;
    bits = (bits | bits << 2) & 0x33333333u;
    return (bits | bits << 1) & 0x55555555u;
}

std::vector<std::uint32_t> tiles(const Places& places, const PeriodicBox& box) {
    const double tiles = static_cast<double>(places.size()) / beads_per_tile;
    const auto along = [&](double side, double other) {
        return std::max(1.0, std::floor(std::sqrt(tiles * (side / other))));
    };
    const double columns = along(box.x, box.y), rows = along(box.y, box.x);
    const auto number = [](double coordinate, double side, double count) {
        return static_cast<std::uint32_t>(std::min(into_box(coordinate, side) / side * count, count - 1.0));
    };
    std::vector<std::uint32_t> tile(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        tile[i] = spread(number(places.x[i], box.x, columns)) | spread(number(places.y[i], box.y, rows)) << 1;
    return tile;
}

} // namespace

Places numbered_by_place(const Places& places, const PeriodicBox& box) {
    const std::vector<std::uint32_t> tile = tiles(places, box);
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return tile[i]; });
    Places sorted;
    for (const std::size_t i : order) {
        sorted.x.push_back(places.x[i]);
        sorted.y.push_back(places.y[i]);
        sorted.z.push_back(places.z[i]);
    }
    return sorted;
}

} // namespace rodwake::granular
