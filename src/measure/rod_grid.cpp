#include "rodwake/measure/rod_grid.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double finest = 512.0; ///< bins in x or y: a block of the displacement then takes 19 MB

/// Column of a coordinate: n stands for the periodic image of column 0.
std::optional<std::size_t> column(double place, const RodGrid& grid) {
    const double k = std::floor(place / grid.spacing + 0.5) + static_cast<double>(grid.n / 2);
    if (!(k >= 0.0 && k <= static_cast<double>(grid.n)))
        return std::nullopt;
    return static_cast<std::size_t>(k) % grid.n;
}

} // namespace

RodGrid::RodGrid(double box, double wanted) {
    if (!(std::isfinite(box) && box > 0.0))
        throw InputError(
            fmt::format("measure: a grid over a box of {:g} m: must be finite and positive", box));
    if (!(wanted > 0.0 && wanted <= box / 4.0 && wanted >= box / finest))
        throw InputError(fmt::format(
            "measure: spacing {:g} m of the grid: must be from {:g} m to a quarter of the box, {:g} m",
            wanted, box / finest, box / 4.0));
    n = 2 * static_cast<std::size_t>(std::max(2.0, std::round(box / (2.0 * wanted))));
    spacing = box / static_cast<double>(n);
}

std::optional<std::size_t> RodGrid::bin(double x, double y) const {
    const auto i = column(x, *this), j = column(y, *this);
    if (!i || !j)
        return std::nullopt;
    return *j * n + *i;
}

Seen seen_from(const RodPlace& rod, double x, double y, double box) {
    const double dx = nearest_image(x - rod.x, box), dy = nearest_image(y - rod.y, box);
    const double c = std::cos(rod.heading), s = std::sin(rod.heading);
    return {c * dx + s * dy, -s * dx + c * dy};
}

} // namespace rodwake::measure
