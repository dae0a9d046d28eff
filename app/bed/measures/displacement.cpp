// The displacement field around the rod.

#include "rodwake/measure/displacement.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::app::measures {

namespace {

using measure::DisplacementAccumulator, measure::DisplacementField;
using scene::Measure, scene::Scene;

void include(const Scene& scene, MeasurePlan& plan) {
    const auto& m = *scene.measure;
    measure::DisplacementOptions options;
    options.method = *m.displacement;
    options.reference = m.reference;
    options.rod = static_cast<std::size_t>(m.rod);
    options.spacing = m.spacing.value_or(scene::measured_radius(scene));
    options.far_from = m.far_from.value_or(0.0);
    options.block = m.block;
    options.mirror = m.mirror;
    include_sums<DisplacementAccumulator>(plan, "displacement", options);
}

void reset_postprocessing_keys(Measure& m) {
    const Measure unset;
    m.profile_offset = unset.profile_offset;
    m.reference = unset.reference;
    m.mirror = unset.mirror;
    m.run_maps = unset.run_maps;
}

/// Not of a force that moves.
bool of_rod(const Scene& scene) { return scene.tracks || !scene.granular->rods.empty(); }

std::string describe(const Scene& scene) {
    const std::string centre = of_rod(scene) ? fmt::format("rod {}", scene.measure->rod) : "the force";
    return fmt::format("field around {} by {}", centre, measure::to_string(*scene.measure->displacement));
}

const char* reference_name(const DisplacementField& u) {
    return u.reference == measure::Reference::box ? "box" : "far";
}

struct ProfileColumns : measure::Profile {
    double a; ///< m

    static constexpr auto fields() {
        using R = ProfileColumns;
        return std::tuple{
            field("x", {"a", "position along the line"},
                  [](const R& r) { return scaled(r.place, 1.0 / r.a); }),
            field("value", {"a", "displacement"}, [](const R& r) { return scaled(r.value, 1.0 / r.a); }),
            field("sigma", {"a", "standard error (empty: unknown, as with one block of time)"},
                  [](const R& r) { return scaled(r.sigma, 1.0 / r.a); }),
            field("count", &R::count, {"1", "samples behind the value"})};
    }
};

CsvFile profile_table(const DisplacementField& u, const char* component, const char* along, double at,
                      double a) {
    const measure::Profile p = measure::profile(u, component, along, at);
    return {fmt::format("profile_{}_{}.csv", component, along),
            fmt::format("displacement {} along {} of the rod's frame at {} = {:g} a; lengths in bead radii, "
                        "a = {:g} m; x is the position along the line",
                        component, along, *along == 'x' ? "y" : "x", p.at / a, a),
            csv_of(ProfileColumns{p, a})};
}

struct DisplacementLayers : DisplacementField {
    double a; ///< m

    static constexpr auto fields() {
        using R = DisplacementLayers;
        return std::tuple{
            field("Ux", {"a", "displacement along the rod's heading (NaN: no data)"},
                  [](const R& r) { return scaled(r.Ux, 1.0 / r.a); }),
            field("Uy", {"a", "displacement across the rod's heading (NaN: no data)"},
                  [](const R& r) { return scaled(r.Uy, 1.0 / r.a); }),
            field("sigma_x", {"a", "standard error of Ux (NaN: unknown)"},
                  [](const R& r) { return scaled(r.sigma_x, 1.0 / r.a); }),
            field("sigma_y", {"a", "standard error of Uy (NaN: unknown)"},
                  [](const R& r) { return scaled(r.sigma_y, 1.0 / r.a); }),
            field("count", &R::count, {"1", "beads behind the value, over all frames"}),
            field("coherence", &R::coherence,
                  {"1", "|mean of exp(i phase)| over the Bragg peaks, 1: the beads kept their lattice"})};
    }
};

MeasureGrid grid_of(const DisplacementField& u, double a, const std::string& group = "/displacement") {
    const double to_a = 1.0 / a;
    MeasureGrid grid{group,
                     u.grid,
                     layers_of(DisplacementLayers{u, a}),
                     {{"method", measure::to_string(u.method)},
                      {"reference", reference_name(u)},
                      {"mean_speed_a_per_s", u.mean_speed * to_a},
                      {"offset_x", u.offset.x * to_a},
                      {"offset_y", u.offset.y * to_a},
                      {"blocks", static_cast<std::int64_t>(u.blocks)}}};
    if (u.grid.margin > 0.0) // no periodic box: what fits and theories of one must not take it for
        grid.attributes.push_back({"window_margin", u.grid.margin * to_a});
    return grid;
}

/// These numbers describe the lattice; they are NaN without Bragg peaks.
double of_lattice(const DisplacementField& u, double value) {
    return u.peaks.lattice_spacing() > 0.0 ? value : std::nan("");
}

struct DisplacementValues : DisplacementField {
    double a; ///< m

    static constexpr auto fields() {
        using R = DisplacementValues;
        return std::tuple{
            field("method", {"Estimator"}, {"", "of the displacement"},
                  [](const R& r) { return measure::to_string(r.method); }),
            field("reference",
                  {"", "what the displacement is relative to: its mean over the box, or the far field"},
                  [](const R& r) { return reference_name(r); }),
            field("spacing", {"Grid spacing"}, {"a", "of the grid on which the displacement is given"},
                  [](const R& r) { return r.grid.width / r.a; }),
            field("blocks", {"Blocks"}, {"1", "of time, for the errors"}, &R::blocks),
            field("frames", {"Frames"}, {"1", "measured for the displacement"}, &R::frames),
            field("block_correlation", {"Correlation of blocks"},
                  {"1", "of one block of time with the next; the errors allow for it"},
                  &R::block_correlation),
            field("mean_speed", {"Speed of the rod"},
                  {"a/s", "along its heading, while the displacement was measured"},
                  [](const R& r) { return r.mean_speed / r.a; }),
            field("offset", {"a", "x and y of what was taken off to make the reference zero"},
                  [](const R& r) {
                      return Column{r.offset.x / r.a, r.offset.y / r.a};
                  }),
            field("row_angle", {"Angle of the rows"}, {"rad", "of the close-packed rows from $x$"},
                  [](const R& r) { return of_lattice(r, r.peaks.row_angle()); }),
            field("lattice_spacing", {"Lattice spacing"}, {"a", "of the beads, from the Bragg peaks"},
                  [](const R& r) { return of_lattice(r, r.peaks.lattice_spacing() / r.a); }),
            field("contrast", {"Bragg contrast"}, {"1", "largest peak"},
                  [](const R& r) { return r.peaks.contrast(); })};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(), to_a = 1.0 / a;
    const double offset = data.scene.measure->profile_offset.value_or(4.0 * a);
    const auto runs = measure::take<DisplacementAccumulator>(data.sums, "displacement");
    const DisplacementField u = measure::reduce(runs);
    std::vector<MeasureGrid> grids = {grid_of(u, a)}; // of all runs, and of each by itself if it is wanted
    for (std::size_t run = 0; data.scene.measure->run_maps && run < runs.size(); ++run)
        grids.push_back(grid_of(measure::reduce(std::span(runs).subspan(run, 1)), a,
                                fmt::format("/runs/{:04}", run + 1)));
    return {.values = record_json(DisplacementValues{u, a}),
            .tables = {profile_table(u, "Ux", "x", 0.0, a), profile_table(u, "Ux", "y", 0.0, a),
                       profile_table(u, "Uy", "x", offset, a), profile_table(u, "Uy", "y", 0.0, a)},
            .grids = std::move(grids),
            .images = {MeasureImage{"displacement.vti",
                                    u.grid,
                                    {{"U", 3, vectors(u.Ux, u.Uy, to_a)},
                                     {"sigma", 3, vectors(u.sigma_x, u.sigma_y, to_a)},
                                     {"count", 1, u.count},
                                     {"coherence", 1, u.coherence}}}},
            .line = fmt::format("displacement field ({}) from {} frames in {} blocks; {} at {:.3g} a/s",
                                measure::to_string(u.method), u.frames, u.blocks,
                                of_rod(data.scene) ? "rod" : "force", u.mean_speed * to_a)};
}

std::vector<FileKind> files() {
    return {{"profile_<k>_<k>.csv", Lifetime::result, "displacement along a line of the rod's frame",
             columns_of<ProfileColumns>()},
            {"displacement.vti", Lifetime::result, "displacement field for ParaView"}};
}

} // namespace

MeasureKind displacement() {
    return {.name = "displacement",
            .order = 40,
            .wanted = [](const Measure& m) { return m.displacement.has_value(); },
            .describe = describe,
            .include = include,
            .reset_postprocessing_keys = reset_postprocessing_keys,
            .report = report,
            .values = values_of<DisplacementValues, true>,
            .layers = columns_of<DisplacementLayers>,
            .files = files};
}

} // namespace rodwake::app::measures
