#include "rodwake/core/error.hpp"
#include "rodwake/measure/displacement.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::measure {

namespace {

void want(bool good, const char* what, const std::string& found, const char* legal) {
    if (!good)
        throw InputError(fmt::format("measure: profile: {} = \"{}\": must be {}", what, found, legal));
}

} // namespace

Profile profile(const DisplacementField& field, const std::string& component, const std::string& along,
                double at) {
    want(component == "Ux" || component == "Uy", "component", component, "Ux or Uy");
    want(along == "x" || along == "y", "along", along, "x or y");
    const RodGrid& grid = field.grid;
    const double line = std::round(at / grid.spacing) + static_cast<double>(grid.n / 2);
    if (!(line >= 0.0 && line < static_cast<double>(grid.n)))
        throw InputError(fmt::format("measure: profile at {:g} m: the grid reaches from {:g} to {:g} m", at,
                                     grid.middle(0), grid.middle(grid.n - 1)));
    const auto& value = component == "Ux" ? field.Ux : field.Uy;
    const auto& sigma = component == "Ux" ? field.sigma_x : field.sigma_y;
    Profile result{component, along, grid.middle(static_cast<std::size_t>(line)), {}, {}, {}, {}};
    for (std::size_t k = 0; k < grid.n; ++k) {
        const std::size_t fixed = static_cast<std::size_t>(line),
                          bin = along == "x" ? fixed * grid.n + k : k * grid.n + fixed;
        if (!(field.count[bin] > 0.0))
            continue;
        result.place.push_back(grid.middle(k));
        result.value.push_back(value[bin]);
        result.sigma.push_back(sigma[bin]);
        result.count.push_back(field.count[bin]);
    }
    return result;
}

} // namespace rodwake::measure
