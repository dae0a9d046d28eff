#include "catalogue.hpp"

#include "bed/granular_summary.hpp"
#include "bed/measure_files.hpp"
#include "fit/fit_records.hpp"
#include "record_table.hpp"
#include "scan/scan_values.hpp"
#include "theory/theory_records.hpp"
#include "tradeoff/target.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace rodwake::app {

namespace {
using enum Lifetime;

constexpr ColumnInfo cut_columns[] = {{"x", "{length}", "place along the cut"},
                                      {"y", "{length}", "place along the cut"},
                                      {"Ux", "{length}", "displacement along the rod's heading"},
                                      {"Uy", "{length}", "displacement across the rod's heading"}};

constexpr ColumnInfo cells_columns[] = {{"outcome", "1", "of all corners of the cell; mixed: they differ"}};
constexpr ColumnInfo boundary_columns[] = {
    {"curve", "1", "number of the curve; its rows are in order along it"},
    {"between", "1", "the two outcomes"},
    {"error", "1", "half the bracket, as a fraction of the axis"}};

/// Rows of which a table has a block of columns a rod, a comparison.
template<Described Row>
struct Each {};

template<class Row>
struct AddColumns {
    static void to(std::vector<ColumnInfo>& columns) { add_columns<Row>(columns); }
};
template<class Row>
struct AddColumns<Each<Row>> {
    static void to(std::vector<ColumnInfo>& columns) { add_columns<Row>(columns, "<k>"); }
};

/// Of a table of such blocks, side by side.
template<class... Rows>
std::span<const ColumnInfo> columns_of() {
    static const std::vector<ColumnInfo> columns = [] {
        std::vector<ColumnInfo> all;
        (AddColumns<Rows>::to(all), ...);
        return all;
    }();
    return columns;
}

/// The numbers of a JSON file.
template<Described Record>
std::span<const ColumnInfo> values_of() {
    static const std::vector<ColumnInfo> values = [] {
        std::vector<ColumnInfo> all;
        add_values<Record>(all);
        return all;
    }();
    return values;
}

std::vector<FileKind> plain_kinds() {
    return {
        {"scene.toml", {}, record, "the scene as resolved: every key with its value"},
        {"provenance.json",
         {},
         record,
         "who made the run, how each stage ended, the command that makes it again, elapsed seconds of the "
         "last "
         "command"},
        {"log.txt", {}, record, "messages of every command that worked on the run"},
        {"manifest.json", {}, record, "this list"},
        {"rodwake.lock", {}, record, "host and process that works on the run, or did last"},
        {"result.h5", {}, result, "field and trajectories as datasets with units"},
        {"report.html", {}, result, "figures and numbers of the run on one page"},

        {"table.csv", Stage::granular, kept, "energy, temperatures, order, contacts against time",
         columns_of<granular::TableRow>()},
        {"tracks.csv", Stage::granular, kept, "rods of the bed against time",
         columns_of<granular::RowTime, Each<granular::TrackPoint>>()},
        {"trajectory.h5md", Stage::granular, kept,
         "places and velocities of all spheres in every stored frame"},
        {"trajectory.xyz", Stage::granular, kept, "the same as extended XYZ"},
        {"last_period.h5md", Stage::granular, kept, "frames of the last period of the plates"},
        {"final.rwc", Stage::granular, kept, "last state, for granular.restart_from"},
        {"measure.rwc", Stage::granular, kept, "what was measured while the run went on"},
        {"checkpoint.rwc", Stage::granular, progress, "state to go on from"},
        {"checkpoint.rwc.previous", Stage::granular, progress,
         "the state before, in case that one is damaged"},
        {"rows.log", Stage::granular, progress, "rows of the tables so far"},
        {"frames.log", Stage::granular, progress, "frames so far"},
        {"last_period.log", Stage::granular, progress, "frames of the last period so far"},

        {"measure.h5", Stage::measure, result, "fields on grids in the rod's frame"},
        {"series.json", Stage::measure, result, "fits over the rows of series.csv"},

        {"fit.json", Stage::fit, result, "parameters with errors, and how good the fit is"},
        {"fit.txt", Stage::fit, result, "the same to read"},
        {"medium.json", Stage::fit, result, "the medium that the fit gives to field and rods"},
        {"fit_profile_<k>.csv", Stage::fit, result, "a profile with its fit", columns_of<FitProfileRow>()},
        {"fit_curve_<k>.csv", Stage::fit, result, "the model along a profile's line",
         columns_of<FitCurveRow, Each<FitComparison>>()},
        {"fit_map_<k>.csv", Stage::fit, result, "a displacement map with its fit", columns_of<FitMapRow>()},
        {"fit_trajectory_<k>.csv", Stage::fit, result, "rods with their fit",
         columns_of<FitTimeRow, Each<MeasuredPose>, Each<FittedPose>>()},
        {"fit_starts.log", Stage::fit, progress, "starts that are done"},

        {"field_cut_<k>.csv", Stage::field, result, "displacement along a line", cut_columns},

        {"ledger.sqlite", Stage::scan, kept,
         "the points of the scan, of beds the runs, as it goes on: tables chunks and causes"},
        {"ledger.sqlite-wal", Stage::scan, progress, "the newest rows of the ledger while it is open"},
        {"ledger.sqlite-shm", Stage::scan, progress, "for who reads the ledger while it is open"},
        {"scan.h5", Stage::scan, result, "the points of the scan and a sample of trajectories as datasets"},
        {"scan.json", Stage::scan, result, "axes, counts, causes of failures, rate of what was missed"},
        {"scan.html", Stage::scan, result, "the scan to explore in a browser"},
        {"cells.csv", Stage::scan, result, "cells of the refinement that were not divided", cells_columns},
        {"boundary.csv", Stage::scan, result, "boundaries between outcomes as curves", boundary_columns},

        {"ways.json", Stage::tradeoff, kept, "the ways to compute a part of a scene that were tried"},
        {"tradeoff.json", Stage::tradeoff, kept, "the reference, and the settings that were tried"},

        {"rods.csv", Stage::rods, result, "rods against time", columns_of<TimeRow, Each<PoseRow>>()},
        {"rods_order.csv", Stage::order, result,
         "order parameters of the rods against time, means over the runs", columns_of<OrderRow>()},
        {"clusters.csv", Stage::order, result, "clusters of the rods by size", columns_of<ClusterRow>()},
        {"rods_order.json", Stage::order, result,
         "means of rods_order.csv from rods_order.from on, with standard errors", values_of<OrderReport>()},
        {"outcome.json", Stage::rods, result, "how the encounter ended, and what the solver did",
         values_of<OutcomeReport>()},
        {"ensemble.csv", Stage::rods, result,
         "a row a run with noise, or a draw of the measured field's errors: how the rods end in it",
         columns_of<DrawnRow, NoisyRow>()},
        {"noise.json", Stage::rods, result,
         "ensemble of runs with noise: probability of capture (contact or pursuit) with the ends of its "
         "interval "
         "of 95 %, endings, first contact; by time, of each rod: mean-square displacement and heading "
         "correlation with standard errors",
         values_of<NoiseReport>()},
        {"medium_film.h5", Stage::rods, result,
         "frames of a dynamic medium: its displacement u on a grid, the sum of the fields of all rods, "
         "also where each rod feels those of the others alone; with the rods' places and headings"},
        {"medium_film.log", Stage::rods, progress, "frames so far"},
        {"noise_progress.json", Stage::rods, progress, "runs with noise that are done, to go on from"},
        {"checkpoint.json", Stage::rods, progress, "state to go on from"}};
}

/// With a column of standard errors behind each that has one.
std::vector<ColumnInfo> columns_of_series() {
    std::vector<ColumnInfo> columns;
    for (const SeriesInfo& info : series_columns()) {
        columns.push_back(info.column);
        if (info.with_error)
            columns.push_back(
                column_info(std::string(info.column.name) + "_error", info.column.unit, "standard error"));
    }
    return columns;
}

/// ValueInfo has the unit of the report, which may have a prefix.
std::string_view unit_in_file(const ValueInfo& value) {
    if (value.factor == 1.0)
        return value.unit.empty() ? "1" : value.unit;
    return value.unit.substr(value.unit.starts_with("\u00b5") ? 2 : 1); // micro has two bytes, milli one
}

std::vector<ColumnInfo> measured_values() {
    std::vector<ColumnInfo> values = {
        {"units.a", "m", "the bead radius"},
        {"phi_b", "1", "area fraction that the scene asks for: of beads, and of rods where they count"}};
    for (const MeasureKind& kind : measure_kinds())
        for (const ValueInfo& value : kind.values)
            if (!value.is_text)
                values.push_back(column_info(std::string(kind.name) + "." + std::string(value.key),
                                             unit_in_file(value), value.meaning));
    return values;
}

std::vector<FileKind> all_kinds() {
    static const std::vector<ColumnInfo> series = columns_of_series(), measured = measured_values(),
                                         runs = runs_columns(), summary = summary_values();
    std::vector<FileKind> all = plain_kinds();
    all.push_back({"runs.csv", Stage::granular, kept, "a row a run of the ensemble", runs});
    all.push_back({"summary.json", Stage::granular, kept,
                   "means of the run, of an ensemble with their errors; SI; cost by part in seconds of wall "
                   "clock; seconds of an ensemble are sums over its runs",
                   summary});
    all.push_back({"scan.csv", Stage::scan, result, "a row a point of the scan; of beds means over its runs",
                   scan_columns()});
    all.push_back({"tradeoff.csv", Stage::tradeoff, result, "a row a setting: its error and its cost",
                   tradeoff_columns()});
    all.push_back({"ways.csv", Stage::tradeoff, result,
                   "a row a way and quantity: value, bias, scatter, cost", ways_columns()});
    all.push_back({"scan_runs.csv", Stage::scan, result, "a row a run of a scan of beds", scan_columns()});
    all.push_back({"measure.json", Stage::measure, result,
                   "what was measured, with errors; lengths in a, speeds in a/s", measured});
    all.push_back(
        {"series.csv", Stage::measure, result, "a row for the scene and one for each variant", series});
    for (const MeasureKind& kind : measure_kinds())
        for (const FileInfo& file : kind.files)
            all.push_back({file.pattern, Stage::measure, result, file.what, file.columns});
    return all;
}

} // namespace

ColumnInfo column_info(std::string name, std::string_view unit, std::string_view meaning) {
    static std::set<std::string> names;
    return {*names.insert(std::move(name)).first, unit, meaning};
}

bool fits(std::string_view name, std::string_view pattern) {
    const auto gap = pattern.find("<k>");
    if (gap == std::string_view::npos)
        return name == pattern;
    if (!name.starts_with(pattern.substr(0, gap)))
        return false;
    const std::string_view rest = pattern.substr(gap + 3);
    for (std::size_t end = gap + 1; end <= name.size(); ++end) {
        if (!std::isalnum(static_cast<unsigned char>(name[end - 1])))
            return false;
        if (fits(name.substr(end), rest))
            return true;
    }
    return false;
}

std::span<const FileKind> file_kinds() {
    static const std::vector<FileKind> kinds = all_kinds();
    return kinds;
}

const FileKind* kind_of(std::string_view name) {
    const auto at =
        std::ranges::find_if(file_kinds(), [&](const FileKind& k) { return fits(name, k.pattern); });
    return at == file_kinds().end() ? nullptr : &*at;
}

std::optional<Stage> stage_of(const FileKind& kind, std::string_view name) {
    return kind.stage == Stage::granular && name.starts_with("points/") ? Stage::scan : kind.stage;
}

const ColumnInfo* column_of(const FileKind& kind, std::string_view name) {
    const auto at =
        std::ranges::find_if(kind.columns, [&](const ColumnInfo& c) { return fits(name, c.name); });
    return at == kind.columns.end() ? nullptr : &*at;
}

} // namespace rodwake::app
