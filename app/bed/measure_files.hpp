#pragma once
// The files of what was measured, whatever it is. An error that is not known is null in JSON, an empty field
// in CSV and NaN on a grid.

#include "rodwake/app/measure_report.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include <filesystem>

namespace rodwake::app {

// `a`: the bead radius, m. All throw RunError.

void write_table(const std::filesystem::path& folder, const MeasureTable& table);
void write_image(const std::filesystem::path& folder, const MeasureImage& image, double a);
void put_grid(store::Hdf5Writer& out, const MeasureGrid& grid, double a);

} // namespace rodwake::app
