#pragma once
// What the measures' source files share.

#include "rodwake/app/measure_kind.hpp"
#include "rodwake/measure/heading_track.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace rodwake::app {

/// The options of a measure, made from the table and the bead radius, as sums that start; fed every `every`
/// times measure.interval.
template<class Sums, class Options>
void include_sums(MeasurePlan& plan, const char* name, const Options& options, std::size_t every = 1) {
    plan.sums.include(name, measure::Accumulator(Sums(plan.sums.layout(), options)), every * plan.stride);
}

/// A value of a result with its unit, its meaning, and the function that gets it: listed once.
template<class Info, class Out, class From>
struct ResultEntry {
    Info info;
    Out (*get)(const From&);

    template<class Get> // a lambda without captures
    consteval ResultEntry(const Info& described, Get)
        : info(described), get([](const From& from) { return Out(converted(Get{}(from))); }) {
        constexpr bool number_of_table = std::same_as<Info, ColumnInfo>;
        if (described.meaning.empty() ||
            (!is_unit(described.unit) && (number_of_table || !described.unit.empty())))
            throw "a result has a meaning and a unit of the list `units`";
    }

private:
    /// Counts are whole numbers, what is absent is nothing.
    template<class T>
    static auto converted(T&& got) {
        using Got = std::remove_cvref_t<T>;
        if constexpr (std::same_as<Out, Value> && std::integral<Got> && !std::same_as<Got, bool>)
            return static_cast<std::int64_t>(got);
        else if constexpr (std::same_as<Out, Value> && requires { got.has_value(); })
            return got ? Value(*got) : Value();
        else if constexpr (std::same_as<Out, double>)
            return static_cast<double>(got);
        else
            return Out(std::forward<T>(got));
    }
};
template<class Result>
using ResultValue = ResultEntry<ValueInfo, Value, Result>; ///< of measure.json
template<class Result>
using ResultColumn = ResultEntry<ColumnInfo, Column, Result>; ///< of a table
template<class Row>
using RowColumn = ResultEntry<ColumnInfo, double, Row>; ///< of a table with a row for each of something

template<class Info, class Out, class From, std::size_t N>
constexpr std::array<Info, N> infos_of(const ResultEntry<Info, Out, From> (&list)[N]) {
    std::array<Info, N> infos{};
    std::ranges::transform(list, infos.begin(), &ResultEntry<Info, Out, From>::info);
    return infos;
}

template<class Result, std::size_t N>
Values values_of(const ResultValue<Result> (&list)[N], const Result& result) {
    Values values;
    for (const ResultValue<Result>& entry : list)
        values.push_back({std::string(entry.info.key), entry.get(result)});
    return values;
}

template<class Result, std::size_t N>
std::vector<Column> columns_of(const ResultColumn<Result> (&list)[N], const Result& result) {
    std::vector<Column> columns;
    for (const ResultColumn<Result>& entry : list)
        columns.push_back(entry.get(result));
    return columns;
}

template<class Row, std::size_t N>
std::vector<Column> columns_of(const RowColumn<Row> (&list)[N], const std::vector<Row>& rows) {
    std::vector<Column> columns;
    for (const RowColumn<Row>& column : list)
        std::ranges::transform(rows, std::back_inserter(columns.emplace_back()), column.get);
    return columns;
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

Column scaled(const Column& values, double scale);
/// Two components as VTK wants vectors.
Column vectors(const Column& x, const Column& y, double scale);

} // namespace rodwake::app
