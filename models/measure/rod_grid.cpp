#include "rodwake/measure/rod_grid.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double finest = 512.0; ///< bins in x or y: a block of the displacement then takes 19 MB

/// Column or row of a coordinate: n stands for the periodic image of 0.
std::optional<std::size_t> column(double place, double spacing, std::size_t n) {
    const double k = std::floor(place / spacing + 0.5) + static_cast<double>(n / 2);
    if (!(k >= 0.0 && k <= static_cast<double>(n)))
        return std::nullopt;
    return static_cast<std::size_t>(k) % n;
}

std::size_t even_count(double side, double wanted) {
    if (!(std::isfinite(side) && side > 0.0))
        throw InputError(
            fmt::format("measure: a grid over a box of {:g} m: must be finite and positive", side));
    if (!(wanted > 0.0 && wanted <= side / 4.0 && wanted >= side / finest))
        throw InputError(fmt::format(
            "measure: spacing {:g} m of the grid: must be from {:g} m to a quarter of the box, {:g} m",
            wanted, side / finest, side / 4.0));
    return 2 * static_cast<std::size_t>(std::max(2.0, std::round(side / (2.0 * wanted))));
}

} // namespace

RodGrid::RodGrid(const PeriodicBox& sides, double wanted)
    : box(sides), columns(even_count(sides.x, wanted)), rows(even_count(sides.y, wanted)),
      width(sides.x / static_cast<double>(columns)), height(sides.y / static_cast<double>(rows)) {}

std::optional<std::size_t> RodGrid::bin(double x, double y) const {
    if (bins() == 0)
        return std::nullopt;
    const auto i = column(x, width, columns), j = column(y, height, rows);
    if (!i || !j)
        return std::nullopt;
    return *j * columns + *i;
}

Seen seen_from(const RodPlace& rod, double x, double y, const PeriodicBox& box) {
    const double dx = nearest_image(x - rod.x, box.x), dy = nearest_image(y - rod.y, box.y);
    const double c = std::cos(rod.heading), s = std::sin(rod.heading);
    return {c * dx + s * dy, -s * dx + c * dy};
}

} // namespace rodwake::measure
