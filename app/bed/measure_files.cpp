#include "measure_stage.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/vti.hpp"
#include "run/record_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>

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

template<class T>
concept Attribute = std::same_as<T, double> || std::same_as<T, std::int64_t> || std::same_as<T, std::string>;

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
    for (const auto& attribute : grid.attributes)
        std::visit(
            [&]<class T>(const T& value) {
                if constexpr (Attribute<T>)
                    out.attribute(grid.group, attribute.name, value);
                else
                    throw RunError(grid.group + ": attribute " + attribute.name +
                                   " is neither number nor text");
            },
            attribute.value);
}

namespace {

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
        for (const MeasureTable& table : report.tables) {
            std::vector<std::string> names;
            for (const ColumnInfo& head : table.heads)
                names.emplace_back(head.name);
            store::write_atomically(folder / table.file, store::to_csv(names, table.columns));
        }
        for (const MeasureImage& image : report.images) {
            const measure::RodGrid& grid = image.grid;
            std::vector<store::VtiArray> arrays;
            for (const ImageArray& array : image.arrays)
                arrays.push_back({array.name, array.components, array.values});
            store::write_vti(folder / image.file,
                             {grid.columns,
                              grid.rows,
                              {grid.x(0) / r.bead_radius, grid.y(0) / r.bead_radius},
                              {grid.width / r.bead_radius, grid.height / r.bead_radius}},
                             arrays);
        }
    }
    write_grids(folder, r);
    // last: whoever finds it finds everything
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
    store::write_atomically(folder / "measure.json", json_text(out, 2) + "\n");
}

std::vector<std::string> describe(const CaseResults& r) {
    const std::string name = r.label.empty() ? "measure" : fmt::format("measure ({})", r.name);
    std::vector<std::string> lines;
    for (const auto& [measure, report] : r.reports)
        lines.push_back(name + ": " + report.line);
    return lines;
}

namespace {

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : ""; }

std::string cell(const std::optional<double>& value, double scale) {
    return value ? cell(*value * scale) : "";
}

/// A column of series.csv that tells of the case itself.
struct CaseColumn {
    SeriesInfo info;
    std::string (*field)(const CaseResults&);
};
using C = const CaseResults&;
constexpr CaseColumn of_case[] = {
    {{{"name", "1", "of the variant; scene: as written"}, false}, [](C r) { return r.name; }},
    {{{"phi_b", "1", "area fraction of the beads"}, false}, [](C r) { return cell(r.phi_b); }},
    {{{"d0", "a", "distance of two rods at the start"}, false},
     [](C r) { return cell(r.separation, 1.0 / r.bead_radius); }},
    {{{"imposed_speed", "a/s", "of the rod (empty: it is free)"}, false},
     [](C r) { return cell(r.imposed_speed, 1.0 / r.bead_radius); }},
    {{{"runs", "1", "finished runs"}, false}, [](C r) { return std::to_string(r.runs); }}};
/// Where readers know the last of them.
constexpr std::string_view before_runs = "delta_y";

} // namespace

std::span<const SeriesInfo> series_columns() {
    static const std::vector<SeriesInfo> columns = [] {
        std::vector<SeriesInfo> all;
        std::ranges::transform(of_case, std::back_inserter(all), &CaseColumn::info);
        const SeriesInfo runs = all.back();
        all.pop_back();
        for (const MeasureKind& kind : measure_kinds())
            all.insert(all.end(), kind.series.begin(), kind.series.end());
        const auto before =
            std::ranges::find(all, before_runs, [](const SeriesInfo& c) { return c.column.name; });
        all.insert(before == all.end() ? before : before + 1, runs);
        return all;
    }();
    return columns;
}

namespace {

Estimate estimate_of(const MeasureReport& report, const SeriesInfo& info) {
    const auto found = std::ranges::find(report.values, info.value, &NamedValue::name);
    if (found == report.values.end())
        return {};
    return info.number ? info.number(found->value) : std::get<Estimate>(found->value);
}

SeriesRow row_of(const CaseResults& r) {
    SeriesRow row{r.imposed_speed, {}};
    for (const auto& [name, report] : r.reports)
        if (const auto kind = std::ranges::find(measure_kinds(), name, &MeasureKind::name);
            kind != measure_kinds().end())
            for (const SeriesInfo& info : kind->series)
                row.values.push_back({info.column.name, estimate_of(report, info)});
    return row;
}

/// "value" or "value,error"; empty fields for what was not measured or is not known.
std::string fields(const SeriesRow& row, const SeriesInfo& info) {
    const auto found = std::ranges::find(row.values, info.column.name, &SeriesValue::name);
    const Estimate e = found == row.values.end() ? Estimate{} : found->value;
    std::string value = e.count > 0 ? cell(e.value) : "";
    if (!info.with_error)
        return value;
    return value + "," + (e.count > 0 && e.known() ? cell(e.error) : "");
}

} // namespace

void write_series(const std::filesystem::path& folder, const std::vector<CaseResults>& cases) {
    std::string text;
    for (const SeriesInfo& info : series_columns()) {
        text += fmt::format("{}{}", text.empty() ? "" : ",", info.column.name);
        if (info.with_error)
            text += fmt::format(",{}_error", info.column.name);
    }
    std::string content = text + "\n";
    for (const CaseResults& results : cases) {
        const SeriesRow row = row_of(results);
        std::vector<std::string> line;
        for (const SeriesInfo& info : series_columns()) {
            const auto own = std::ranges::find(of_case, info.column.name,
                                               [](const CaseColumn& c) { return c.info.column.name; });
            line.push_back(own != std::end(of_case) ? own->field(results) : fields(row, info));
        }
        content += fmt::format("{}\n", fmt::join(line, ","));
    }
    store::write_atomically(folder / "series.csv", content);
    std::vector<SeriesRow> rows;
    std::ranges::transform(cases, std::back_inserter(rows), row_of);
    Values all;
    for (const MeasureKind& kind : measure_kinds())
        if (kind.compare)
            std::ranges::move(kind.compare(rows), std::back_inserter(all));
    if (!all.empty())
        store::write_atomically(folder / "series.json", json_text(values_json(all), 2) + "\n");
}

} // namespace rodwake::app
