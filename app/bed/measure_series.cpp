// series.csv: one row for each case; series.json: what measures tell of all of them.

#include "measure_results.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/values_json.hpp"
#include "series_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

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

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.17g}", value) : ""; }

std::string cell(const std::optional<double>& value, double scale) {
    return value ? cell(*value * scale) : "";
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

/// Fields of the case itself; nothing for a column of a measure.
std::optional<std::string> field_of_case(const CaseResults& r, std::string_view column) {
    const double to_a = 1.0 / r.bead_radius;
    if (column == "name")
        return r.name;
    if (column == "phi_b")
        return cell(r.phi_b);
    if (column == "d0")
        return cell(r.separation, to_a);
    if (column == "imposed_speed")
        return cell(r.imposed_speed, to_a);
    return column == "runs" ? std::optional(std::to_string(r.runs)) : std::nullopt;
}

std::string line_of(const CaseResults& r) {
    const SeriesRow row = row_of(r);
    std::vector<std::string> line;
    for (const SeriesInfo& info : series_columns()) {
        const auto own = field_of_case(r, info.column.name);
        line.push_back(own ? *own : fields(row, info));
    }
    return fmt::format("{}\n", fmt::join(line, ","));
}

std::string header() {
    std::string text;
    for (const SeriesInfo& info : series_columns()) {
        text += fmt::format("{}{}", text.empty() ? "" : ",", info.column.name);
        if (info.with_error)
            text += fmt::format(",{}_error", info.column.name);
    }
    return text + "\n";
}

Values comparisons(const std::vector<CaseResults>& cases) {
    std::vector<SeriesRow> rows;
    std::ranges::transform(cases, std::back_inserter(rows), row_of);
    Values all;
    for (const MeasureKind& kind : measure_kinds())
        if (kind.compare)
            std::ranges::move(kind.compare(rows), std::back_inserter(all));
    return all;
}

} // namespace

void write_series(const std::filesystem::path& folder, const std::vector<CaseResults>& cases) {
    std::string content = header();
    for (const CaseResults& one : cases)
        content += line_of(one);
    store::write_atomically(folder / "series.csv", content);
    if (const Values told = comparisons(cases); !told.empty())
        store::write_atomically(folder / "series.json", values_json(told).dump(2) + "\n");
}

} // namespace rodwake::app
