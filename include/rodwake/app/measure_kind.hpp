#pragma once
// The measures. Each has one source file, app/bed/measures/<name>.cpp, which holds all that lies between
// the scene and the results: when it is wanted, what is summed over frames, how the sums become values and
// files, and what those mean. Plans, checkpoints, result files, catalogue, schema and report go by this list.

#include "rodwake/app/measure.hpp"
#include "rodwake/app/measure_report.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rodwake::app {

/// What one run of the bed wrote beside its frames, or a film has of its rods (tracks from its first frame
/// on, NaN where a rod is not known). Both throw InputError where there is none such.
struct RunTables {
    /// A number of its summary.json ("rods.0.force"); `what` names it in messages.
    std::function<double(const std::string& name, const std::string& what)> summary;
    /// Columns of its tracks.csv, by name.
    std::function<std::vector<Column>(const std::vector<std::string>& names)> tracks;
};

/// What a measure is made from: one case, all its runs.
struct MeasuredCase {
    const scene::Scene& scene;
    std::span<measure::Measures> sums; ///< over the runs' frames; a measure may take its own out
    std::vector<RunTables> tables;     ///< of the runs; none of a trajectory from elsewhere
    std::optional<double> film = {};   ///< of [tracks]: from its first frame to the last, s
    /// Name and report of the measures before this one in the list.
    std::span<const std::pair<std::string, MeasureReport>> earlier = {};

    double bead_radius() const { return scene::measured_radius(scene); } ///< m
};

/// What a case has in the columns of this name of series.csv.
struct SeriesValue {
    std::string_view name;
    Estimate value; ///< count 0: not measured
};

/// A row of series.csv.
struct SeriesRow {
    std::optional<double> imposed_speed; ///< of the rod, m/s
    std::vector<SeriesValue> values;     ///< of all measures
};

/// A file in the folder of the case.
struct FileInfo {
    std::string_view pattern; ///< its name; "<k>" stands for a number or a word
    std::string_view what;
    std::span<const ColumnInfo> columns = {}; ///< of a CSV file
};

/// Columns `name` and, with an error, `name`_error of series.csv.
struct SeriesInfo {
    ColumnInfo column;
    bool with_error = true;
    std::string_view value = column.name;       ///< of the measure, an Estimate, which it is
    Estimate (*number)(const Value&) = nullptr; ///< of that value, if it is none
};

/// A value of measure.json. Title and meaning are text with formulas as TeX between dollars.
struct ValueInfo {
    std::string_view key;
    std::string_view title = {}; ///< of its row in the report; "": it has none
    std::string_view unit = {};  ///< of the value times `factor`; "": none
    std::string_view meaning = {};
    double factor = 1.0;  ///< from the file to the report
    bool is_text = false; ///< without unit and factor
};

struct MeasureKind {
    std::string_view name; ///< of its file, its sums, its table in measure.json and its key in [measure]
    int order = 0;         ///< place in the list; taken so far are tens
    bool (*wanted)(const scene::Measure&) = nullptr;
    /// How it is measured, if it is wanted.
    std::string (*describe)(const scene::Scene&) = nullptr;
    /// Takes its sums into the plan, whose interval is known; null: made from the runs' own tables.
    void (*include)(const scene::Scene&, MeasurePlan&) = nullptr;
    /// Resets the keys that its sums do not depend on, so that they may change without new frames; null:
    /// none.
    void (*reset_postprocessing_keys)(scene::Measure&) = nullptr;
    /// Throws InputError or RunError if it cannot be had.
    MeasureReport (*report)(const MeasuredCase&) = nullptr;
    /// What it tells of several cases together, for series.json; null: nothing.
    Values (*compare)(std::span<const SeriesRow>) = nullptr;
    std::span<const ValueInfo> values;
    std::span<const FileInfo> files = {};
    std::span<const SeriesInfo> series = {}; ///< in series.csv
};

/// By `order`: that of states, measure.json and series.csv.
std::span<const MeasureKind> measure_kinds();

} // namespace rodwake::app
