#include "rod_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::elastic {

namespace {

struct Box {
    double x0, x1, y0, y1;
};

template<class Range, class At>
Box box_around(const Range& range, const At& at) {
    const KernelSource& first = at(*range.begin());
    Box box{first.x, first.x, first.y, first.y};
    for (const auto& one : range) {
        const KernelSource& rod = at(one);
        box = {std::min(box.x0, rod.x), std::max(box.x1, rod.x), std::min(box.y0, rod.y),
               std::max(box.y1, rod.y)};
    }
    return box;
}

/// Half of a number of rods, in whole tiles, or in whole blocks if there are several.
std::size_t half_of(std::size_t count) {
    const std::size_t unit = count > block_rods ? block_rods : tile_rods, units = (count + unit - 1) / unit;
    return units / 2 * unit;
}

void split(std::span<const KernelSource> rods, std::span<std::uint32_t> numbers) {
    if (numbers.size() <= tile_rods) {
        std::sort(numbers.begin(), numbers.end());
        return;
    }
    const Box box = box_around(numbers, [&](std::uint32_t k) -> const KernelSource& { return rods[k]; });
    const bool across = box.x1 - box.x0 >= box.y1 - box.y0;
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const double at_a = across ? rods[a].x : rods[a].y, at_b = across ? rods[b].x : rods[b].y;
        return at_a != at_b ? at_a < at_b : a < b;
    };
    const std::size_t half = half_of(numbers.size());
    std::nth_element(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(half), numbers.end(),
                     less);
    split(rods, numbers.first(half));
    split(rods, numbers.subspan(half));
}

} // namespace

std::vector<std::uint32_t> compact_order(std::span<const KernelSource> rods) {
    std::vector<std::uint32_t> numbers(rods.size());
    std::iota(numbers.begin(), numbers.end(), 0U);
    split(rods, numbers);
    return numbers;
}

Circle circle_around(std::span<const KernelSource> rods) {
    const Box box = box_around(rods, [](const KernelSource& rod) -> const KernelSource& { return rod; });
    const double x = 0.5 * (box.x0 + box.x1), y = 0.5 * (box.y0 + box.y1);
    double radius = 0.0;
    for (const KernelSource& rod : rods)
        radius = std::max(radius, std::hypot(rod.x - x, rod.y - y));
    return {x, y, radius};
}

} // namespace rodwake::elastic
