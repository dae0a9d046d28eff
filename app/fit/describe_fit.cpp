#include "run/describe_parts.hpp"

#include "rodwake/core/box_sides.hpp"
#include <fmt/format.h>

#include <numbers>

namespace rodwake::app {

namespace {

void add_maps(const scene::Fit& keys, const FitInputs& inputs, Lines& lines) {
    if (keys.maps.empty())
        return;
    for (std::size_t i = 0; i < inputs.maps.size(); ++i) {
        const std::optional<FitMapData>& map = inputs.maps[i];
        lines.push_back({true, map ? fmt::format("fit: {} x {} bins of {}, box {:g} x {:g}, rod at {:g}",
                                                 map->data.x.size(), map->data.y.size(), map->file.string(),
                                                 map->data.lx, map->data.ly, map->data.speed)
                                   : "fit: bins of a map that the run makes"});
    }
    std::string masked = "no mask, every bin counts";
    if (!keys.masks.empty()) {
        const fitting::MapMask mask = map_mask(keys.masks.front());
        masked = fmt::format("|y| >= {:g}, r >= {:g}, {:.0f} to {:.0f} deg from the heading", mask.strip,
                             mask.radius, mask.from * 180.0 / std::numbers::pi,
                             mask.to * 180.0 / std::numbers::pi);
        if (keys.masks.size() > 1)
            masked += fmt::format("; {} other masks tried", keys.masks.size() - 1);
    }
    lines.push_back({true, "fit of maps: " + masked});
    for (const auto& [name, error] : keys.fixed_errors)
        lines.push_back({true, fmt::format("fit: {} is held with an error of {:g}", name, error)});
}

void add_term(const scene::Fit& keys, const std::string& parameter, std::string_view what, Lines& lines) {
    const bool in = scene::fit_has(keys, parameter);
    lines.push_back({in, in ? fmt::format("fit term: {} ({})", what, parameter)
                            : fmt::format("fit term: no {}: {} is not in fit.parameters, fixed or tied", what,
                                          parameter)});
}

void add_map_terms(const scene::Fit& keys, Lines& lines) {
    if (keys.maps.empty())
        return;
    const bool isotropic = scene::fit_is_isotropic(keys);
    if (isotropic)
        add_term(keys, "f_over_mu", "monopole in an isotropic medium, of the maps", lines);
    else
        add_term(keys, "force", "monopole in an orthotropic medium", lines);
    add_term(keys, "p_xx", "dipole along the rod", lines);
    add_term(keys, "p_yy", "dipole across the rod", lines);
    add_term(keys, "q_xxx", "second moment of the force along the rod by x^2", lines);
    add_term(keys, "q_xyy", "second moment of the force along the rod by y^2", lines);
    add_term(keys, "q_yxy", "second moment of the force across the rod by xy", lines);
    add_term(keys, "t_xxxx", "third moment of the force along the rod by x^3", lines);
    add_term(keys, "t_xxyy", "third moment of the force along the rod by x y^2", lines);
    add_term(keys, "h_xxxxx", "fourth moment of the force along the rod by x^4", lines);
    add_term(keys, "h_xxxyy", "fourth moment of the force along the rod by x^2 y^2", lines);
    if (keys.measured_drag)
        lines.push_back({true, "fit: drag_area is held at what the run measures"});
    if (isotropic)
        return;
    add_term(keys, "zeta", "drag of the medium", lines);
    add_term(keys, "rho", "inertia of the medium", lines);
    add_term(keys, "eta_s", "viscosity of the medium", lines);
}

void add_terms(const scene::Fit& keys, Lines& lines) {
    add_map_terms(keys, lines);
    if (!keys.profiles.empty() && !scene::fit_is_isotropic(keys)) {
        add_term(keys, "f_over_mu", "monopole in an isotropic medium", lines);
        add_term(keys, "f2d_over_mu", "dipole", lines);
        add_term(keys, "x0", "distance of the force ahead of the centre", lines);
        add_term(keys, "offset", "offset of Ux", lines);
        add_term(keys, "offset_y", "offset of Uy", lines);
        lines.push_back({keys.box.has_value(),
                         keys.box ? fmt::format("fit term: images in a box of {}", to_string(*keys.box))
                                  : "fit term: no images: no fit.box, infinite plane"});
        lines.push_back({keys.core > 0.0, keys.core > 0.0
                                              ? fmt::format("fit: |position| < {:g} left out", keys.core)
                                              : "fit core: all points count, fit.core is 0"});
    }
    if (!keys.trajectories.empty())
        for (const rods::Coupling& coupling : rods::coupling_list)
            add_term(keys, std::string(coupling.name), coupling.words, lines);
    for (const rods::OtherTurning& turning : rods::other_turning)
        if (scene::fit_has(keys, std::string(turning.name)))
            add_term(keys, std::string(turning.name), turning.words, lines);
    for (const char* name : {"D_r", "D_t"})
        if (scene::fit_has(keys, name))
            add_term(keys, name, "diffusion of the rods, of tracks", lines);
    for (const scene::FitModel& model : keys.models)
        lines.push_back(
            {true, fmt::format("fit: model \"{}\" with {}", model.name, fmt::join(model.set, ", "))});
}

} // namespace

void describe_fit(const Plan& plan, Lines& lines) {
    if (!plan.scene.fit || !plan.fit) {
        lines.push_back({false, "fit: no [fit] table"});
        return;
    }
    const scene::Fit& keys = *plan.scene.fit;
    const fitting::SearchOptions& method = keys.search;
    lines.push_back(
        {true, fmt::format("fit of {}: {}", fmt::join(keys.parameters, ", "),
                           fmt::format("{} from {} start{}, seed {}{}", to_string(method.algorithm),
                                       method.starts, method.starts == 1 ? "" : "s", method.seed,
                                       method.levenberg_marquardt ? ", polished" : ""))});
    for (const auto& [name, value] : keys.fixed)
        lines.push_back({true, fmt::format("fit: {} = {:g} held", name, value)});
    for (const auto& [name, tie] : keys.tied)
        lines.push_back({true, fmt::format("fit: {} = {:g} {}", name, tie.factor, tie.to)});
    const FitInputs& inputs = *plan.fit;
    for (std::size_t i = 0; i < keys.profiles.size(); ++i) {
        const scene::FitProfile& p = keys.profiles[i];
        const std::optional<FitProfileData>& data = inputs.profiles[i];
        const std::string points =
            data ? fmt::format("{} of {} points of {}",
                               fitting::outside_core(data->data, keys.core).place.size(),
                               data->data.place.size(), data->file.string())
                 : fmt::format("the points of {}, which the run makes", p.file);
        lines.push_back({true, fmt::format("fit: {} along {} at {} = {:g} {}: {}", p.component, p.along,
                                           p.along == "x" ? "y" : "x", p.at,
                                           p.role == scene::FitRole::fit ? "fitted" : "predicted", points)});
    }
    for (std::size_t i = 0; i < keys.trajectories.size(); ++i) {
        const std::optional<FitTrackData>& data = inputs.tracks[i];
        lines.push_back(
            {true, data ? fmt::format("fit: {} rods, {} rows of {}", data->rods, data->data.times.size(),
                                      data->file.string())
                        : fmt::format("fit: rods of {}, which the run makes", keys.trajectories[i].file)});
    }
    add_maps(keys, *plan.fit, lines);
    add_terms(keys, lines);
}

} // namespace rodwake::app
