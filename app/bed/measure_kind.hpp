#pragma once
// The measures. Each has one source file, app/bed/measures/<name>.cpp, which holds all that lies between
// the scene and the results: when it is wanted, what is summed over frames, how the sums become values and
// files, and what those mean. Plans, checkpoints, result files, catalogue, schema and report go by this list.

#include "bed/measure_report.hpp"
#include "rodwake/app/measure.hpp"
#include "rodwake/core/record.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::app {

struct FileKind;  // app/run/catalogue.hpp
struct SeriesRow; // app/bed/series_row.hpp

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
    SeriesRow& row;                    ///< for its numbers of series.csv; has those of measures before it
    std::optional<double> film = {};   ///< of [tracks]: from its first frame to the last, s

    double bead_radius() const { return scene::measured_radius(scene); } ///< m
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
    /// Fills in its numbers of series.csv, too. Throws InputError or RunError if it cannot be had.
    MeasureReport (*report)(const MeasuredCase&) = nullptr;
    /// Compares several cases for series.json; null: there is nothing to compare.
    nlohmann::ordered_json (*compare)(std::span<const SeriesRow>) = nullptr;
    /// values_of<..., true> of the record that is its part of measure.json.
    std::span<const ColumnInfo> (*values)() = nullptr;
    std::span<const ColumnInfo> (*film_numbers)() = nullptr; ///< further ones, of [tracks] alone
    std::span<const ColumnInfo> (*layers)() = nullptr;       ///< of its group of measure.h5
    std::vector<FileKind> (*files)() = nullptr;              ///< in the folder of the case
};

/// By `order`: that of states, measure.json and series.csv.
std::span<const MeasureKind> measure_kinds();

} // namespace rodwake::app
