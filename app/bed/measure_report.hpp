#pragma once
// The results of a measure are plain data: values, tables, grids. Units are those of the files: lengths in
// bead radii a, times in s, the rest SI. Whoever writes the files knows no single measure.

#include "rodwake/measure/rod_grid.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rodwake::app {

using Column = std::vector<double>;

struct CsvFile {
    std::string name, comment; ///< of measure.json: what the file is
    std::string text;
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
    std::vector<std::pair<std::string, std::variant<double, std::int64_t, std::string>>> attributes = {};
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
    nlohmann::ordered_json values; ///< its part of measure.json
    std::vector<CsvFile> tables = {};
    std::vector<MeasureGrid> grids = {};
    std::vector<MeasureImage> images = {};
    std::string line = {}; ///< for the terminal
};

} // namespace rodwake::app
