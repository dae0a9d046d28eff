#include "measure_stage.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/vti.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Middles of the columns (x) or rows (y).
Column middles(const measure::RodGrid& grid, char axis, double scale) {
    Column out;
    for (std::size_t k = 0; k < (axis == 'x' ? grid.columns : grid.rows); ++k)
        out.push_back((axis == 'x' ? grid.x(k) : grid.y(k)) * scale);
    return out;
}

} // namespace

void put_grid(store::Hdf5Writer& out, const MeasureGrid& grid, double a) {
    const measure::RodGrid& bins = grid.grid;
    out.dataset(grid.group + "/x", middles(bins, 'x', 1.0 / a), {bins.columns}, "a");
    out.dataset(grid.group + "/y", middles(bins, 'y', 1.0 / a), {bins.rows}, "a");
    for (const GridLayer& layer : grid.layers)
        out.dataset(grid.group + "/" + layer.name, layer.values, {bins.rows, bins.columns}, layer.unit);
    out.attribute(grid.group, "spacing", bins.width / a);
    if (!bins.box.square())
        out.attribute(grid.group, "spacing_y", bins.height / a);
    for (const auto& [name, attribute] : grid.attributes)
        std::visit([&, &name = name](const auto& value) { out.attribute(grid.group, name, value); },
                   attribute);
}

void write_measures(const fs::path& folder, const CaseResults& r, const MeasureOrigin& origin) {
    for (const auto& [name, report] : r.reports) {
        for (const CsvFile& table : report.tables)
            store::write_atomically(folder / table.name, table.text);
        for (const MeasureImage& image : report.images) {
            const measure::RodGrid& grid = image.grid;
            std::vector<store::VtiArray> arrays;
            for (const ImageArray& array : image.arrays)
                arrays.push_back({array.name, array.components, array.values});
            store::write_vti(folder / image.file,
                             {grid.columns,
                              grid.rows,
                              {grid.x(0) / r.row.bead_radius, grid.y(0) / r.row.bead_radius},
                              {grid.width / r.row.bead_radius, grid.height / r.row.bead_radius}},
                             arrays);
        }
    }
    // measure.h5: the grids of all measures, by the names of their groups; no file without any.
    std::vector<const MeasureGrid*> grids;
    for (const auto& [name, report] : r.reports)
        for (const MeasureGrid& grid : report.grids)
            grids.push_back(&grid);
    if (!grids.empty()) {
        std::ranges::sort(grids, {}, [](const auto* grid) { return grid->group; });
        store::Hdf5Writer h5(folder / "measure.h5");
        h5.attribute("/", "bead_radius", r.row.bead_radius);
        h5.attribute("/", "phi_b", r.row.phi_b);
        for (const auto* grid : grids)
            put_grid(h5, *grid, r.row.bead_radius);
        h5.commit();
    }
    // last: whoever finds it finds everything
    ordered_json out = {
        {"units",
         {{"length", "a"}, {"time", "s"}, {"a", r.row.bead_radius}, {"force", "N"}, {"spring", "N/m"}}},
        {"phi_b", r.row.phi_b},
        {"runs", r.row.runs}};
    for (const auto& [name, report] : r.reports)
        out[name] = report.values;
    for (const auto& [name, report] : r.reports)
        for (const CsvFile& table : report.tables)
            out["tables"][table.name] = table.comment;
    for (const auto& [name, reason] : r.not_measured)
        out["not_measured"][name] = reason;
    out["provenance"] = {{"command", origin.command},
                         {"seed", origin.seed},
                         {"version", build_info().version},
                         {"git", build_info().git}};
    store::write_atomically(folder / "measure.json", json_text(out, 2) + "\n");
}

std::vector<std::string> describe(const CaseResults& r) {
    const std::string name = r.label.empty() ? "measure" : fmt::format("measure ({})", r.row.name);
    std::vector<std::string> lines;
    for (const auto& [measure, report] : r.reports)
        lines.push_back(name + ": " + report.line);
    return lines;
}

namespace {

// Cells of series.csv; an Estimate has one for its error, too. What is not known is empty.

std::string cell(const std::string& text) { return text; }
std::string cell(std::size_t number) { return std::to_string(number); }
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : ""; }
std::string cell(const Estimate& e) { return e.count > 0 ? cell(e.value) + "," + cell(e.error) : ","; }

} // namespace

void write_series(const std::filesystem::path& folder, const std::vector<CaseResults>& cases) {
    std::vector<std::string> line;
    for (const ColumnInfo& column : columns_of<SeriesRow>())
        line.emplace_back(column.name);
    std::string content = fmt::format("{}\n", fmt::join(line, ","));
    std::vector<SeriesRow> rows;
    for (const CaseResults& results : cases) {
        rows.push_back(results.row);
        line.clear();
        for_each_field<SeriesRow>([&](const auto& field) { line.push_back(cell(field.of(results.row))); });
        content += fmt::format("{}\n", fmt::join(line, ","));
    }
    store::write_atomically(folder / "series.csv", content);
    ordered_json all;
    for (const MeasureKind& kind : measure_kinds())
        if (kind.compare)
            all.update(kind.compare(rows));
    if (!all.empty())
        store::write_atomically(folder / "series.json", json_text(all, 2) + "\n");
}

} // namespace rodwake::app
