// What a measured displacement map is worth in a fit, wherever it comes from.

#include "rodwake/app/fit.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

double spacing(const std::vector<double>& places) { return places[1] - places[0]; }

/// Sigmas of no bin: equal weights. Of some bins: the others are left out.
void settle_sigmas(FitMapData& out) {
    fitting::Map& map = out.data;
    const auto known = [&](std::size_t bin) {
        return std::isfinite(map.sigma_x[bin]) && std::isfinite(map.sigma_y[bin]);
    };
    bool any = false;
    for (std::size_t bin = 0; bin < map.bins(); ++bin)
        any = any || (map.known[bin] && known(bin));
    if (!any) {
        map.sigma_x.clear();
        map.sigma_y.clear();
        return;
    }
    for (std::size_t bin = 0; bin < map.bins(); ++bin)
        if (map.known[bin] && !known(bin)) {
            map.known[bin] = false;
            ++out.left_out;
        }
}

/// measure.mirror puts the same numbers on both sides, which must not count twice.
bool is_mirrored(const fitting::Map& map) {
    const std::size_t nx = map.x.size(), ny = map.y.size();
    std::size_t compared = 0;
    for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t k = 0; k < nx; ++k) {
            const auto other = std::ranges::find_if(
                map.y, [&](double y) { return std::abs(y + map.y[j]) < 1e-6 * spacing(map.y); });
            if (map.y[j] >= 0.0 || other == map.y.end())
                continue;
            const std::size_t a = j * nx + k, b = static_cast<std::size_t>(other - map.y.begin()) * nx + k;
            if (!map.known[a] || !map.known[b])
                continue;
            ++compared;
            if (map.Ux[a] != map.Ux[b] || map.Uy[a] != -map.Uy[b])
                return false;
        }
    return compared > 0;
}

void take_one_half(fitting::Map& map) {
    for (std::size_t bin = 0; bin < map.bins(); ++bin)
        map.known[bin] = map.known[bin] && map.place_y(bin) > 0.0; // at y = 0 mirroring makes U_y zero
}

} // namespace

void settle_map(FitMapData& out, std::optional<double> independent_spacing) {
    fitting::Map& map = out.data;
    settle_sigmas(out);
    out.mirrored = is_mirrored(map);
    if (out.mirrored)
        take_one_half(map);
    if (independent_spacing)
        map.independent =
            std::max(std::min(1.0, spacing(map.x) / *independent_spacing) *
                         std::min(1.0, spacing(map.y) / *independent_spacing),
                     1.0 / static_cast<double>(map.bins())); // they are worth one value together at least
}

} // namespace rodwake::app
