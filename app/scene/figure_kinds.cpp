#include "figure_kinds.hpp"

#include "diagnostics.hpp"

#include <algorithm>

namespace rodwake::scene {

namespace {

using enum FigureSubject;

template<bool Measure::*what>
bool is_measured(const Scene& s, const Figure&) {
    return s.measure && (*s.measure).*what;
}

constexpr FigureNeed grid{"[field] with x and y",
                          [](const Scene& s, const Figure&) { return s.field && !s.field->x.empty(); }};
constexpr FigureNeed gammas{"gammas = [[gamma1, gamma2], ...]",
                            [](const Scene&, const Figure& f) { return !f.gammas.empty(); }};
constexpr FigureNeed cuts{"[[field.cuts]]",
                          [](const Scene& s, const Figure&) { return s.field && !s.field->cuts.empty(); }};
constexpr FigureNeed rods{"[[rods]]", [](const Scene& s, const Figure&) { return !s.rods.empty(); }};
constexpr FigureNeed medium_frames{
    "medium.field = \"dynamic\" with medium.dynamic.film_interval", [](const Scene& s, const Figure&) {
        return s.medium && s.medium->is_dynamic() && s.medium->memory().film_interval;
    }};
constexpr FigureNeed noise{"[noise] with rotational_diffusion or translational_diffusion above 0",
                           [](const Scene& s, const Figure&) { return noisy(s); }};
constexpr FigureNeed rods_order{"[rods_order]",
                                [](const Scene& s, const Figure&) { return s.rods_order.has_value(); }};
constexpr FigureNeed bed_itself{"[granular]",
                                [](const Scene& s, const Figure&) { return s.granular.has_value(); }};
constexpr FigureNeed beads{"[granular] or [tracks]",
                           [](const Scene& s, const Figure&) { return s.granular || s.tracks; }};
constexpr FigureNeed frames{"\"h5md\" in granular.output.formats", [](const Scene& s, const Figure&) {
                                return !s.granular || contains(s.granular->output.formats, "h5md");
                            }};
constexpr FigureNeed all_beads{"granular.output.every_bead = 1", [](const Scene& s, const Figure&) {
                                   return !s.granular || s.granular->output.every_bead == 1;
                               }};
constexpr FigureNeed rods_in_bed{"[[granular.rods]]",
                                 [](const Scene& s, const Figure&) { return !s.granular->rods.empty(); }};
constexpr FigureNeed last_period{"granular.output.last_period = true", [](const Scene& s, const Figure&) {
                                     return s.granular->output.last_period;
                                 }};
constexpr FigureNeed variants{"[[variants]]: a point each",
                              [](const Scene& s, const Figure&) { return !s.variants.empty(); }};
constexpr FigureNeed order{"measure.order = true", is_measured<&Measure::order>};
constexpr FigureNeed microrheology{"measure.microrheology = true", is_measured<&Measure::microrheology>};
constexpr FigureNeed flow{"measure.flow = true", is_measured<&Measure::flow>};
constexpr FigureNeed pairs{"measure.pairs = true", is_measured<&Measure::pairs>};
constexpr FigureNeed force{"measure.force = true", is_measured<&Measure::force>};
constexpr FigureNeed phonons{"measure.phonons = true", is_measured<&Measure::phonons>};
constexpr FigureNeed mechanics{"measure.mechanics = true", is_measured<&Measure::mechanics>};
constexpr FigureNeed heading_diffusion{"measure.heading_diffusion = true",
                                       is_measured<&Measure::heading_diffusion>};
constexpr FigureNeed displacement{"measure.displacement", [](const Scene& s, const Figure&) {
                                      return s.measure && s.measure->displacement;
                                  }};
constexpr FigureNeed a_fit{"[fit]", [](const Scene& s, const Figure&) { return s.fit.has_value(); }};
constexpr FigureNeed profiles{"[[fit.profiles]]",
                              [](const Scene& s, const Figure&) { return !s.fit->profiles.empty(); }};
constexpr FigureNeed tracks{"[[fit.trajectories]]",
                            [](const Scene& s, const Figure&) { return !s.fit->trajectories.empty(); }};
constexpr FigureNeed maps{"[[fit.maps]]", [](const Scene& s, const Figure&) { return !s.fit->maps.empty(); }};
constexpr FigureNeed models{"[[fit.models]]",
                            [](const Scene& s, const Figure&) { return !s.fit->models.empty(); }};
constexpr FigureNeed starts{"fit.starts of 2 or more",
                            [](const Scene& s, const Figure&) { return s.fit->search.starts >= 2; }};
constexpr FigureNeed likelihood{"fit.likelihood",
                                [](const Scene& s, const Figure&) { return !s.fit->likelihood.empty(); }};
constexpr FigureNeed posterior{"[fit.posterior]",
                               [](const Scene& s, const Figure&) { return s.fit->posterior.has_value(); }};
constexpr FigureNeed a_scan{"[scan]", [](const Scene& s, const Figure&) { return s.scan.has_value(); }};

} // namespace

const std::vector<FigureKind>& figure_kinds() {
    static const std::vector<FigureKind> kinds = {
        {"snapshot",
         "beads and rods from above; of [tracks] the frame with most beads, with the paths of the rods",
         bed,
         {beads, frames, all_beads},
         {"trajectory.h5md", "film_frame.csv", "rod_tracks.csv"},
         {"frame", "colour", "x", "y"}},
        {"rod_tracks",
         "paths, headings and speeds of the rods in the bed",
         bed,
         {bed_itself, rods_in_bed},
         {"tracks.csv"},
         {}},
        {"side_view",
         "a slice of the bed between the plates over one period",
         bed,
         {bed_itself, last_period, all_beads},
         {"last_period.h5md"},
         {"x", "y"}},
        {"movie",
         "film of the stored frames",
         bed,
         {bed_itself, frames, all_beads},
         {"trajectory.h5md"},
         {"colour", "fps", "x", "y"}},
        {"granular_table", "temperatures, order and overlap in time", bed, {bed_itself}, {"table.csv"}, {}},
        {"pair_correlation", "g(r) of the beads", measure, {beads, order}, {"gr.csv"}, {"x"}},
        {"bond_order", "correlation g_B(r) of the bond order", measure, {beads, order}, {"gB.csv"}, {"x"}},
        {"msd", "mean-square displacement of the beads", measure, {beads, microrheology}, {"msd.csv"}, {}},
        {"stiffness",
         "1/(s MSD~(s)) and its value at s = 0",
         measure,
         {beads, microrheology},
         {"stiffness.csv"},
         {}},
        {"memory_kernel",
         "memory kernel of what holds a bead against s, and the stiffness at s = 0",
         measure,
         {bed_itself, microrheology},
         {"memory_kernel.csv"},
         {}},
        {"phonons",
         "frequency, damping and temperature of the modes against q, by direction",
         measure,
         {bed_itself, phonons},
         {"phonons.csv"},
         {}},
        {"heading_diffusion",
         "mean-square heading change of the rod and mean cosine of it, with the fits",
         measure,
         {beads, heading_diffusion},
         {"heading.csv"},
         {}},
        {"flow",
         "velocity of the beads in the rod's frame",
         measure,
         {beads, flow},
         {"measure.h5"},
         {"x", "y"}},
        {"dragged",
         "where marked beads went as the rod passed",
         measure,
         {bed_itself, flow, all_beads},
         {"marked.csv", "trajectory.h5md"},
         {"x", "y"}},
        {"displacement_map",
         "displacement U of the beads in the rod's frame",
         measure,
         {beads, displacement},
         {"measure.h5"},
         {"component", "x", "y"}},
        {"profile",
         "U along an axis of the rod's frame",
         measure,
         {beads, displacement},
         {"profile_Ux_x.csv", "profile_Ux_y.csv", "profile_Uy_x.csv", "profile_Uy_y.csv"},
         {"component", "along", "sqrt_scaled", "x", "y"}},
        {"pair_tracks",
         "paths and separation of two rods",
         measure,
         {beads, pairs},
         {"tracks.csv", "rod_tracks.csv", "pairs.csv"},
         {}},
        {"series",
         "one number of the scene and of each variant",
         measure,
         {bed_itself, variants},
         {"series.csv"},
         {"quantity", "against"},
         {{"psi6", order},
          {"stiffness", microrheology},
          {"exponent", order},
          {"delta_y", pairs},
          {"non_reciprocity", pairs},
          {"force", force},
          {"speed", force},
          {"c_T", phonons},
          {"C11", phonons},
          {"C22", phonons},
          {"C66", phonons},
          {"drag_rate", mechanics},
          {"screening_length", mechanics},
          {"D_r", heading_diffusion},
          {"diffusion_per_length", heading_diffusion}}},
        {"theory_beside_bed",
         "U along lines, of the bed and of the theory side by side",
         measure,
         {bed_itself, displacement, cuts},
         {"profile_Ux_x.csv", "profile_Uy_x.csv", "result.h5"},
         {}},
        {"trajectories", "paths of the rods of the theory", theory, {rods}, {"result.h5"}, {"x", "y"}},
        {"rods_movie", "film of the rods of the theory", theory, {rods}, {"result.h5"}, {"fps", "x", "y"}},
        {"medium_film",
         "film of the displacement |u| of a dynamic medium and of the rods in it",
         theory,
         {rods, medium_frames},
         {"medium_film.h5"},
         {"fps", "x", "y"}},
        {"medium_instants",
         "displacement |u| of a dynamic medium and the rods in it, at four times",
         theory,
         {rods, medium_frames},
         {"medium_film.h5"},
         {"x", "y"}},
        {"noise",
         "spread, headings and contacts of rods that diffuse, next to a rod without neighbours",
         theory,
         {rods, noise},
         {"noise.json", "ensemble.csv"},
         {}},
        {"rods_order",
         "order parameters and clusters of rods in time",
         rod_order,
         {rods_order},
         {"rods_order.csv", "clusters.csv"},
         {}},
        {"extensional_axis",
         "extensional axis of the strain around a rod",
         theory,
         {grid},
         {"result.h5"},
         {"x", "y"}},
        {"polar_streamlines",
         "direction in which the polar couplings turn a rod",
         theory,
         {grid, gammas},
         {"result.h5"},
         {"gammas", "x", "y"}},
        {"cut",
         "U along a line of the theory's field",
         theory,
         {cuts},
         {"result.h5"},
         {"cut", "component", "sqrt_scaled", "x", "y"}},
        {"fit",
         "measured profiles and the fit",
         FigureSubject::fit,
         {a_fit, profiles},
         {"fit.json"},
         {"profiles", "residuals", "x", "y"}},
        {"fit_map",
         "measured displacement maps, the fit and what is left",
         FigureSubject::fit,
         {a_fit, maps},
         {"fit.json"},
         {}},
        {"fit_trajectories",
         "measured tracks and the fit",
         FigureSubject::fit,
         {a_fit, tracks},
         {"fit.json"},
         {}},
        {"fit_likelihood",
         "profile likelihood of a parameter",
         FigureSubject::fit,
         {a_fit, likelihood},
         {"fit.json"},
         {"parameter"}},
        {"fit_correlation",
         "correlations of the fitted parameters",
         FigureSubject::fit,
         {a_fit},
         {"fit.json"},
         {}},
        {"fit_starts",
         "where the starts of the search ended",
         FigureSubject::fit,
         {a_fit, starts},
         {"fit.json"},
         {}},
        {"posterior",
         "samples of the fitted parameters, each by itself and in pairs, with priors and least squares",
         FigureSubject::fit,
         {a_fit, posterior},
         {"posterior.json", "posterior.csv"},
         {}},
        {"posterior_trace",
         "samples of the fitted parameters along the chains",
         FigureSubject::fit,
         {a_fit, posterior},
         {"posterior.json", "posterior.csv"},
         {}},
        {"posterior_predictive",
         "measured profiles and what the posterior predicts, with and without the noise of the data",
         FigureSubject::fit,
         {a_fit, posterior, profiles},
         {"posterior.json"},
         {"profiles"}},
        {"posterior_trajectories",
         "measured tracks and what the posterior predicts, with and without the noise of the data",
         FigureSubject::fit,
         {a_fit, posterior, tracks},
         {"posterior.json"},
         {}},
        {"fit_models",
         "model comparison: AIC, BIC and cross-validation relative to the best model, and weights",
         FigureSubject::fit,
         {a_fit, models},
         {"models.json"},
         {}},
        {"phase_diagram",
         "outcomes, or a number, over the axes of a scan",
         scan,
         {a_scan},
         {"scan.json", "scan.csv", "cells.csv", "boundary.csv"},
         {"colour", "cells", "boundary", "slices", "x", "y"}},
        {"critical_values",
         "critical values of a scan along its first axis, curves for each value of the second",
         scan,
         {a_scan},
         {"critical.csv", "critical.json", "scan.json"},
         {"x", "y"}},
        {"scan_curve",
         "a number of a scan along its first axis, a curve for each value of the second",
         scan,
         {a_scan},
         {"scan.json", "scan.csv"},
         {"column", "x", "y"}},
    };
    return kinds;
}

std::string_view to_string(FigureSubject subject) {
    static constexpr std::string_view names[] = {"bed", "measure", "theory", "rod_order", "fit", "scan"};
    return names[static_cast<std::size_t>(subject)];
}

const FigureKind* find_figure_kind(const std::string& name) {
    const auto it = std::ranges::find(figure_kinds(), name, &FigureKind::name);
    return it == figure_kinds().end() ? nullptr : &*it;
}

std::span<const std::string_view> figure_kind_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const FigureKind& kind : figure_kinds())
            all.push_back(kind.name);
        return all;
    }();
    return names;
}

std::span<const std::string_view> figure_quantities() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const FigureKind& kind : figure_kinds())
            for (const auto& [name, need] : kind.quantities)
                all.push_back(name);
        return all;
    }();
    return names;
}

bool has_key(const Figure& figure, std::string_view key) {
    const FigureKind* kind = find_figure_kind(figure.kind);
    return kind && contains(kind->keys, key);
}

bool shows(const Figure& figure, FigureSubject subject) {
    const FigureKind* kind = find_figure_kind(figure.kind);
    return kind && kind->subject == subject;
}

std::vector<std::string> kinds_with(std::string_view key) {
    std::vector<std::string> names;
    for (const FigureKind& kind : figure_kinds())
        if (contains(kind.keys, key))
            names.push_back(kind.name);
    return names;
}

} // namespace rodwake::scene
