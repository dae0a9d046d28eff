#pragma once
// What a measure found, as plain data: values, tables, grids, its part of series.csv. Units are those of the
// files: lengths in bead radii a, times in s, the rest SI. Whoever writes the files knows no single measure.

#include "rodwake/core/estimate.hpp"
#include "rodwake/core/record.hpp"
#include "rodwake/measure/rod_grid.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rodwake::app {

using Column = std::vector<double>;

/// std::monostate: there is none (null in JSON). An Estimate is {"value", "error", "samples"}.
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string, Estimate, Column>;

/// A dot in a name opens a table: "chi2.algebraic" is {"chi2": {"algebraic": ...}}.
struct NamedValue {
    std::string name;
    Value value;
};
using Values = std::vector<NamedValue>;

/// A CSV file: columns of equal length. NaN is an empty field.
struct MeasureTable {
    std::string file, comment;         ///< what it is, for measure.json
    std::span<const ColumnInfo> heads; ///< static
    std::vector<Column> columns;
};

/// One field [row y][column x] of a grid.
struct GridLayer {
    std::string name;
    Column values;
    std::string unit; ///< "": none
};

/// A group of measure.h5.
struct MeasureGrid {
    std::string group; ///< "/flow"
    measure::RodGrid grid;
    std::vector<GridLayer> layers;
    Values attributes = {}; ///< numbers and texts
};

/// A scalar (1 component) or a vector (3) at each point.
struct ImageArray {
    std::string name;
    std::size_t components;
    Column values; ///< [row y][column x][component], finite
};

/// A VTK file (.vti).
struct MeasureImage {
    std::string file;
    measure::RodGrid grid;
    std::vector<ImageArray> arrays;
};

struct MeasureReport {
    Values values; ///< its part of measure.json
    std::vector<MeasureTable> tables = {};
    std::vector<MeasureGrid> grids = {};
    std::vector<MeasureImage> images = {};
    std::string line = {}; ///< for the terminal
};

} // namespace rodwake::app
