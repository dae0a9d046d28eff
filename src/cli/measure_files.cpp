#include "measure_json.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "rodwake/store/vti.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;
using Column = std::vector<double>;

Column scaled(const Column& values, double scale) {
    Column out = values;
    for (double& value : out)
        value *= scale;
    return out;
}

/// Errors for a CSV file: an empty field for one that is not known.
Column errors(const Column& values, double scale = 1.0) {
    Column out = values;
    for (double& value : out)
        value = value < 0.0 ? std::nan("") : value * scale;
    return out;
}

/// Errors for a grid, where -1 stands for one that is not known.
Column grid_errors(const Column& values, double scale) {
    Column out = values;
    for (double& value : out)
        value = value < 0.0 ? -1.0 : value * scale;
    return out;
}

void write_csv(const fs::path& file, const std::string& comment, const std::vector<std::string>& names,
               const std::vector<Column>& columns) {
    store::write_atomically(file, "# " + comment + "\n" + store::to_csv(names, columns));
}

void write_structure(const fs::path& folder, const measure::StructureResult& r, double a) {
    write_csv(folder / "gr.csv", "pair correlation g(r); r in bead radii a", {"r", "g", "sigma"},
              {scaled(r.r, 1.0 / a), r.g, errors(r.g_error)});
    write_csv(folder / "gB.csv", "bond-orientational correlation g_B(r); r in a; pairs behind each value",
              {"r", "gB", "sigma", "pairs"},
              {scaled(r.order_r, 1.0 / a), r.g_B, errors(r.g_B_error), r.order_pairs});
}

void write_microrheology(const fs::path& folder, const measure::MicrorheologyResult& r, double a) {
    const double area = 1.0 / (a * a);
    write_csv(folder / "msd.csv", "mean-square displacement, drift removed; lag in s, msd in a^2",
              {"lag", "msd", "sigma", "origins"},
              {r.lag, scaled(r.msd, area), errors(r.msd_error, area), r.origins});
    write_csv(folder / "stiffness.csv", "1/(s MSD~(s)) in 1/a^2; s in 1/s", {"s", "value", "sigma"},
              {r.s, scaled(r.stiffness, a * a), errors(r.stiffness_error, a * a)});
}

void write_profile(const fs::path& folder, const measure::DisplacementField& u, const char* component,
                   const char* along, double at, double a) {
    const measure::Profile p = measure::profile(u, component, along, at);
    write_csv(
        folder / fmt::format("profile_{}_{}.csv", component, along),
        fmt::format(
            "displacement {} along {} of the rod's frame at {} = {:g} a; lengths in bead radii, a = {:g} m; "
            "x is the place along the line",
            component, along, *along == 'x' ? "y" : "x", p.at / a, a),
        {"x", "value", "sigma", "count"},
        {scaled(p.place, 1.0 / a), scaled(p.value, 1.0 / a), errors(p.sigma, 1.0 / a), p.count});
}

Column middles(const measure::RodGrid& grid, double scale) {
    Column out;
    for (std::size_t k = 0; k < grid.n; ++k)
        out.push_back(grid.middle(k) * scale);
    return out;
}

/// Two components as VTK wants vectors.
Column vectors(const Column& x, const Column& y, double scale) {
    Column out;
    for (std::size_t i = 0; i < x.size(); ++i)
        out.insert(out.end(), {x[i] * scale, y[i] * scale, 0.0});
    return out;
}

store::VtiGrid vti_grid(const measure::RodGrid& grid, double a) {
    const double first = grid.middle(0) / a, spacing = grid.spacing / a;
    return {grid.n, grid.n, {first, first}, {spacing, spacing}};
}

/// One field of a grid in measure.h5.
struct Layer {
    const char* name;
    const Column* values;
    double scale;
    const char* unit;
};

void put_grid(store::Hdf5Writer& out, const std::string& group, const measure::RodGrid& grid, double a,
              std::initializer_list<Layer> layers) {
    for (const char* axis : {"x", "y"})
        out.dataset(group + "/" + axis, middles(grid, 1.0 / a), {grid.n}, "a");
    for (const Layer& layer : layers) {
        const bool error = std::string_view(layer.name).starts_with("sigma");
        out.dataset(group + "/" + layer.name,
                    error ? grid_errors(*layer.values, layer.scale) : scaled(*layer.values, layer.scale),
                    {grid.n, grid.n}, layer.unit);
    }
    out.attribute(group, "unknown_sigma", -1.0);
    out.attribute(group, "spacing", grid.spacing / a);
}

void write_displacement(store::Hdf5Writer& h5, const fs::path& folder, const measure::DisplacementField& u,
                        const CaseResults& r) {
    const double a = r.bead_radius, to_a = 1.0 / a;
    write_profile(folder, u, "Ux", "x", 0.0, a);
    write_profile(folder, u, "Ux", "y", 0.0, a);
    write_profile(folder, u, "Uy", "x", r.profile_offset, a);
    write_profile(folder, u, "Uy", "y", 0.0, a);
    put_grid(h5, "/displacement", u.grid, a,
             {{"Ux", &u.Ux, to_a, "a"},
              {"Uy", &u.Uy, to_a, "a"},
              {"sigma_x", &u.sigma_x, to_a, "a"},
              {"sigma_y", &u.sigma_y, to_a, "a"},
              {"count", &u.count, 1.0, ""},
              {"coherence", &u.coherence, 1.0, ""}});
    h5.attribute("/displacement", "method", std::string(to_string(u.method)));
    h5.attribute("/displacement", "reference",
                 std::string(u.reference == measure::Reference::box ? "box" : "far"));
    h5.attribute("/displacement", "mean_speed_a_per_s", u.mean_speed * to_a);
    h5.attribute("/displacement", "offset_x", u.offset.x * to_a);
    h5.attribute("/displacement", "offset_y", u.offset.y * to_a);
    h5.attribute("/displacement", "blocks", static_cast<std::int64_t>(u.blocks));
    const Column U = vectors(u.Ux, u.Uy, to_a), sigma = vectors(u.sigma_x, u.sigma_y, to_a);
    const std::array<store::VtiArray, 4> arrays = {
        {{"U", 3, U}, {"sigma", 3, sigma}, {"count", 1, u.count}, {"coherence", 1, u.coherence}}};
    store::write_vti(folder / "displacement.vti", vti_grid(u.grid, a), arrays);
}

void write_marked(const fs::path& folder, const std::vector<measure::MarkedBead>& marked, double a) {
    std::vector<Column> columns(5);
    for (const measure::MarkedBead& m : marked) {
        const double row[] = {static_cast<double>(m.bead), m.x0 / a, m.y0 / a, m.x1 / a, m.y1 / a};
        for (std::size_t k = 0; k < 5; ++k)
            columns[k].push_back(row[k]);
    }
    write_csv(folder / "marked.csv",
              "of run 1: beads near the rod in the first frame, there and in the last frame, unwrapped, "
              "drift removed; a",
              {"bead", "x0", "y0", "x1", "y1"}, columns);
}

void write_flow(store::Hdf5Writer& h5, const fs::path& folder, const measure::FlowField& f, double a) {
    const double to_a = 1.0 / a;
    put_grid(h5, "/flow", f.grid, a,
             {{"vx", &f.vx, to_a, "a/s"},
              {"vy", &f.vy, to_a, "a/s"},
              {"sigma_x", &f.sigma_x, to_a, "a/s"},
              {"sigma_y", &f.sigma_y, to_a, "a/s"},
              {"unit_x", &f.unit_x, 1.0, ""},
              {"unit_y", &f.unit_y, 1.0, ""},
              {"count", &f.count, 1.0, ""}});
    const Column v = vectors(f.vx, f.vy, to_a), unit = vectors(f.unit_x, f.unit_y, 1.0);
    const std::array<store::VtiArray, 3> arrays = {
        {{"velocity", 3, v}, {"unit", 3, unit}, {"count", 1, f.count}}};
    store::write_vti(folder / "flow.vti", vti_grid(f.grid, a), arrays);
    write_marked(folder, f.marked, a);
}

void write_pairs(const fs::path& folder, const measure::PairResult& pairs, double a) {
    const std::vector<std::string> names = {
        "run",    "separation",      "half_box_change", "last_change", "turn0",        "turn1",
        "leader", "non_reciprocity", "min_separation",  "outcome",     "outcome_time", "perpendicular"};
    std::vector<Column> columns(names.size());
    for (std::size_t i = 0; i < pairs.runs.size(); ++i) {
        const measure::PairRun& p = pairs.runs[i];
        const double row[] = {static_cast<double>(i + 1),
                              p.separation / a,
                              p.half_box_change ? *p.half_box_change / a : std::nan(""),
                              p.last_change / a,
                              p.turn[0],
                              p.turn[1],
                              static_cast<double>(p.leader),
                              p.non_reciprocity,
                              p.min_separation / a,
                              static_cast<double>(p.outcome),
                              p.outcome_time,
                              p.perpendicular ? 1.0 : 0.0};
        for (std::size_t k = 0; k < columns.size(); ++k)
            columns[k].push_back(row[k]);
    }
    write_csv(folder / "pairs.csv",
              "lengths in a, angles in rad, times in s; outcome 0 contact, 1 pursuit, 2 escape; "
              "half_box_change empty: the "
              "rods did not come half a box",
              names, columns);
}

/// What an earlier measure of this folder left: files that this one does not make would tell of another.
void remove_earlier(const fs::path& folder) {
    for (const char* name : {"measure.json", "measure.h5", "gr.csv", "gB.csv", "msd.csv", "stiffness.csv",
                             "marked.csv", "pairs.csv", "displacement.vti", "flow.vti", "profile_Ux_x.csv",
                             "profile_Ux_y.csv", "profile_Uy_x.csv", "profile_Uy_y.csv"})
        fs::remove(folder / name);
}

} // namespace

void write_measures(const fs::path& folder, const CaseResults& r, const MeasureOrigin& origin) {
    const double a = r.bead_radius;
    remove_earlier(folder);
    if (r.structure)
        write_structure(folder, *r.structure, a);
    if (r.microrheology)
        write_microrheology(folder, *r.microrheology, a);
    if (r.pairs)
        write_pairs(folder, *r.pairs, a);
    if (r.flow || r.displacement) {
        store::Hdf5Writer h5(folder / "measure.h5");
        h5.attribute("/", "bead_radius", a);
        h5.attribute("/", "phi_b", r.phi_b);
        if (r.displacement)
            write_displacement(h5, folder, *r.displacement, r);
        if (r.flow)
            write_flow(h5, folder, *r.flow, a);
        h5.commit();
    }
    // last: whoever finds it finds everything
    store::write_atomically(folder / "measure.json", measure_json(r, origin));
}

} // namespace rodwake::cli
