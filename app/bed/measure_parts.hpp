#pragma once
// What the measures' source files share.

#include "bed/measure_kind.hpp"
#include "rodwake/measure/heading_track.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "series_row.hpp"

#include <string>
#include <vector>

namespace rodwake::app {

/// The options of a measure, made from the table and the bead radius, as sums that start; fed every `every`
/// times measure.interval.
template<class Sums, class Options>
void include_sums(MeasurePlan& plan, const char* name, const Options& options, std::size_t every = 1) {
    plan.sums.include(name, measure::Accumulator(Sums(plan.sums.layout(), options)), every * plan.stride);
}

/// "value +- error"
std::string text(const Estimate& e);

/// m*, the inertia of the moving bed over the mass of its beads (measure/drift_decay.hpp).
struct Inertia {
    Estimate factor;    ///< count 0: none is known, and the mass of the beads is used
    std::string source; ///< in words, for measure.json
};
/// measure.inertia_factor; else as these runs tell it, if mechanics is measured and tells it well enough.
Inertia inertia_of(const MeasuredCase& data);

/// A number of each run's summary.json.
std::vector<double> of_summaries(const MeasuredCase& data, const std::string& name, const std::string& what);

/// Of the rod measure.rod in this run, from t = 0, `from` and `from_travel` on.
measure::HeadingTrack track_of(const scene::Measure& measure, const RunTables& run);

/// The layers of a grid are the columns of a described record; a pure number has no unit in HDF5.
template<Described Layers>
std::vector<GridLayer> layers_of(const Layers& layers) {
    std::vector<GridLayer> all;
    for_each_field<Layers>([&](const auto& field) {
        const std::string unit(field.info.unit == "1" ? "" : field.info.unit);
        all.push_back({std::string(field.name), field.of(layers), unit});
    });
    return all;
}

Column scaled(const Column& values, double scale);
/// Two components as VTK wants vectors.
Column vectors(const Column& x, const Column& y, double scale);

} // namespace rodwake::app
