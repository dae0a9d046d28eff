#include "measure_results.hpp"

#include "measure_files.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/values_json.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::string measure_json(const CaseResults& r, const MeasureOrigin& origin) {
    ordered_json out = {
        {"units", {{"length", "a"}, {"time", "s"}, {"a", r.bead_radius}, {"force", "N"}, {"spring", "N/m"}}},
        {"phi_b", r.phi_b},
        {"runs", r.runs}};
    for (const auto& [name, report] : r.reports)
        out[name] = values_json(report.values);
    for (const auto& [name, report] : r.reports)
        for (const MeasureTable& table : report.tables)
            out["tables"][table.file] = table.comment;
    for (const auto& [name, reason] : r.not_measured)
        out["not_measured"][name] = reason;
    out["provenance"] = {{"command", origin.command},
                         {"seed", origin.seed},
                         {"version", build_info().version},
                         {"git", build_info().git}};
    return out.dump(2) + "\n";
}

/// measure.h5: the grids of all measures, by the names of their groups; no file without any.
void write_grids(const fs::path& folder, const CaseResults& r) {
    std::vector<const MeasureGrid*> grids;
    for (const auto& [name, report] : r.reports)
        for (const MeasureGrid& grid : report.grids)
            grids.push_back(&grid);
    if (grids.empty())
        return;
    std::ranges::sort(grids, {}, [](const auto* grid) { return grid->group; });
    store::Hdf5Writer h5(folder / "measure.h5");
    h5.attribute("/", "bead_radius", r.bead_radius);
    h5.attribute("/", "phi_b", r.phi_b);
    for (const auto* grid : grids)
        put_grid(h5, *grid, r.bead_radius);
    h5.commit();
}

} // namespace

void write_measures(const fs::path& folder, const CaseResults& r, const MeasureOrigin& origin) {
    for (const auto& [name, report] : r.reports) {
        for (const MeasureTable& table : report.tables)
            write_table(folder, table);
        for (const MeasureImage& image : report.images)
            write_image(folder, image, r.bead_radius);
    }
    write_grids(folder, r);
    // last: whoever finds it finds everything
    store::write_atomically(folder / "measure.json", measure_json(r, origin));
}

std::vector<std::string> describe(const CaseResults& r) {
    const std::string name = r.label.empty() ? "measure" : fmt::format("measure ({})", r.name);
    std::vector<std::string> lines;
    for (const auto& [measure, report] : r.reports)
        lines.push_back(name + ": " + report.line);
    return lines;
}

} // namespace rodwake::app
