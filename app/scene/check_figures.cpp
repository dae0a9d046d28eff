#include "check.hpp"

#include "diagnostics.hpp"
#include "figure_kinds.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

/// What the figure needs and the scene lacks; empty: nothing.
std::string_view missing(const Figure& figure, const FigureKind& kind, const Scene& scene) {
    for (const FigureNeed& need : kind.needs)
        if (!need.is_met(scene, figure))
            return need.text;
    for (const auto& [quantity, need] : kind.quantities)
        if (quantity == figure.quantity && !need.is_met(scene, figure))
            return need.text;
    return "";
}

/// Indices and names that point into other tables, which are there.
void references(const Figure& figure, const std::string& path, const Scene& scene, const Report& report) {
    if (figure.kind == "cut" && static_cast<std::size_t>(figure.cut) >= scene.field->cuts.size())
        report(path + ".cut", fmt::format("there is no cut {}: field.cuts has {} (numbered from 0)",
                                          figure.cut, scene.field->cuts.size()));
    for (std::size_t i = 0; figure.kind == "fit" && i < figure.profiles.size(); ++i)
        if (static_cast<std::size_t>(figure.profiles[i]) >= scene.fit->profiles.size())
            report(fmt::format("{}.profiles.{}", path, i),
                   fmt::format("there is no profile {}: fit.profiles has {} (numbered from 0)",
                               figure.profiles[i], scene.fit->profiles.size()));
    if (figure.kind == "snapshot" && scene.tracks && figure.frame != Figure().frame)
        report(path + ".frame",
               "frame belongs to snapshots of a bed: of [tracks] the frame with most beads is shown");
    if (figure.kind == "fit_likelihood" && !figure.parameter.empty() &&
        !contains(scene.fit->likelihood, figure.parameter))
        report(path + ".parameter", fmt::format("{} is not in fit.likelihood, which has {}", figure.parameter,
                                                comma_list(scene.fit->likelihood)));
}

} // namespace

void check_figures(const Scene& scene, const Report& report) {
    const Figure unset;
    for (std::size_t i = 0; i < scene.figures.size(); ++i) {
        const Figure& figure = scene.figures[i];
        const std::string path = fmt::format("figures.{}", i);
        check_window(figure.x, path + ".x", report);
        check_window(figure.y, path + ".y", report);

        // Keys that only some kinds have must be at their defaults elsewhere.
        const Figure& f = figure;
        const std::pair<const char*, bool> changed[] = {
            {"cut", f.cut != unset.cut},
            {"component", f.component != unset.component},
            {"sqrt_scaled", f.sqrt_scaled != unset.sqrt_scaled},
            {"along", f.along != unset.along},
            {"quantity", !f.quantity.empty() && f.quantity != figure_quantities().front()},
            {"against", f.against != unset.against},
            {"gammas", f.gammas != unset.gammas},
            {"frame", f.frame != unset.frame},
            {"colour", f.colour != unset.colour},
            {"fps", f.fps != unset.fps},
            {"profiles", f.profiles != unset.profiles},
            {"residuals", f.residuals != unset.residuals},
            {"parameter", f.parameter != unset.parameter},
            {"cells", f.cells != unset.cells},
            {"boundary", f.boundary != unset.boundary},
            {"slices", f.slices != unset.slices},
            {"column", f.column != unset.column}};
        for (const auto& [key, is_changed] : changed)
            if (is_changed && !has_key(figure, key)) {
                std::vector<std::string> kinds = kinds_with(key); // "kind movie", "kinds a, b and c"
                const std::string last = kinds.back();
                kinds.pop_back();
                report(path + "." + key,
                       fmt::format("{} belongs to {} only", key,
                                   kinds.empty() ? "kind " + last
                                                 : fmt::format("kinds {} and {}", comma_list(kinds), last)));
            }
        if (figure.component == "U" && figure.kind != "displacement_map" && has_key(figure, "component"))
            report(path + ".component", "the size U belongs to kind displacement_map only: Ux or Uy");
        if (has_key(figure, "colour") && !shows(figure, FigureSubject::scan) && figure.colour != "order" &&
            figure.colour != "orientation")
            report(path + ".colour", fmt::format("{}.colour = \"{}\": of kind {} it is order or orientation",
                                                 path, figure.colour, figure.kind));
        if (figure.kind == "profile" && figure.sqrt_scaled && figure.along == "y")
            report(path + ".sqrt_scaled",
                   "sqrt_scaled belongs to profiles along x: behind the rod U falls as |x|^(-1/2)");
        const FigureKind* kind = find_figure_kind(figure.kind);
        if (!kind)
            continue;
        if (const auto what = missing(figure, *kind, scene); !what.empty())
            report(path + ".kind", fmt::format("a figure of kind {} needs {}", figure.kind, what));
        else
            references(figure, path, scene, report);
    }
}

} // namespace rodwake::scene
