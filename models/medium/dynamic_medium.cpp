#include "rodwake/medium/dynamic_medium.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::medium {

namespace {

constexpr std::size_t fewest_modes = 4, most_modes = 2048;
constexpr double least_inertia = 1e-12, most_inertia = 1e6; // smaller ones overflow a mode's rates
constexpr double most_own_width = 10.0; // alpha force_width, beyond which own_response.cpp's integral is off

} // namespace

Evaluation evaluation_of(const DynamicMedium& medium, std::size_t rods) {
    if (medium.closure != Closure::none)
        return Evaluation::sums;
    if (medium.evaluation != Evaluation::automatic)
        return medium.evaluation;
    return rods > (medium.self_field ? most_summed : most_fields) ? Evaluation::mesh : Evaluation::sums;
}

double bytes_needed(const DynamicMedium& medium, std::size_t rods) {
    const double modes = 0.5 * static_cast<double>(medium.modes) * static_cast<double>(medium.modes);
    const double parts = medium.inertia > 0.0 ? 2.0 : 1.0; // amplitudes, and their rates
    if (evaluation_of(medium, rods) == Evaluation::mesh)
        // six states and four forces, weights of each mode, and the mesh with its transforms
        return 8.0 * (modes * (4.0 * (6.0 * parts + 4.0) + (parts > 1.0 ? 36.0 : 14.0) + 20.0) +
                      60.0 * static_cast<double>(rods));
    const double own = rods > most_fields ? 0.0 : static_cast<double>(rods);
    const double fields = medium.self_field ? 1.0 + own : static_cast<double>(rods);
    // amplitudes: four numbers a mode in each of eight states of the fields; weights: ten complex numbers a
    // rod, or with inertia four forces
    return 8.0 * modes * (32.0 * parts * fields + 20.0 * static_cast<double>(rods));
}

void validate(const elastic::Medium& elastic, const DynamicMedium& medium, std::size_t rods) {
    elastic::validate(elastic);
    if (!(medium.box > 0.0 && std::isfinite(medium.box)))
        throw InputError(
            fmt::format("box = {}: the side of the periodic medium must be > 0 and finite", medium.box));
    if (medium.modes < fewest_modes || medium.modes > most_modes)
        throw InputError(fmt::format("modes = {}: must be {} to {}", medium.modes, fewest_modes, most_modes));
    if (!(medium.force_width > 0.0 && std::isfinite(medium.force_width)))
        throw InputError(fmt::format("force_width = {}: must be > 0 and finite", medium.force_width));
    const double spacing = medium.box / static_cast<double>(medium.modes);
    if (medium.force_width < spacing)
        throw InputError(
            fmt::format("force_width = {} is below the grid spacing box/modes = {:.4g}: take modes = "
                        "{:.0f} or more, or a wider force",
                        medium.force_width, spacing, std::ceil(medium.box / medium.force_width)));
    if (medium.box < 4.0 * medium.force_width)
        throw InputError(
            fmt::format("box = {} is less than 4 force_width = {}: the force would overlap its own "
                        "images",
                        medium.box, 4.0 * medium.force_width));
    if (medium.closure != Closure::none && medium.start == Start::rest)
        throw InputError("a closure has no initial state, so start = \"rest\" needs closure = \"none\": take "
                         "start = \"steady\", or closure = \"none\"");
    if (medium.closure != Closure::none && (medium.evaluation == Evaluation::mesh || medium.inertia > 0.0))
        throw InputError("a closure needs direct sums and no inertia: take evaluation = \"auto\" and inertia "
                         "= 0, or closure = \"none\"");
    if (medium.inertia != 0.0 && !(medium.inertia >= least_inertia && medium.inertia <= most_inertia))
        throw InputError(
            fmt::format("inertia = {}: must be 0, or {} to {}", medium.inertia, least_inertia, most_inertia));
    const bool mesh = evaluation_of(medium, rods) == Evaluation::mesh;
    if (!mesh && !medium.self_field && rods > most_fields)
        throw InputError(fmt::format(
            "self_field = false with sums keeps a field for each rod, of at most {} rods, not {}: "
            "take fewer rods, evaluation = \"mesh\" or self_field = true, which has one field for "
            "all",
            most_fields, rods));
    if (mesh && !medium.self_field && medium.inertia > 0.0)
        throw InputError(
            fmt::format("inertia = {} with self_field = false is not available for {} rods, which are "
                        "evaluated on a mesh: use self_field = true, or at most {} rods (direct sums)",
                        medium.inertia, rods, most_fields));
    if (mesh && !medium.self_field && medium.force_width > most_own_width * elastic.xi)
        throw InputError(
            fmt::format("self_field = false with the mesh, which {} rods get, takes a rod's own "
                        "field off for alpha force_width up to {}, not {:.3g}; take self_field = "
                        "true, or sums for at most {} rods",
                        rods, most_own_width, medium.force_width / elastic.xi, most_fields));
    if (bytes_needed(medium, rods) > most_bytes)
        throw InputError(
            fmt::format("modes = {} and {} rods would take {:.3g} GB: at most {:.3g}; take fewer modes or "
                        "rods",
                        medium.modes, rods, 1e-9 * bytes_needed(medium, rods), 1e-9 * most_bytes));
}

} // namespace rodwake::medium
