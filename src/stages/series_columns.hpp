#pragma once
// The columns of series.csv: of the case, and of every measure, whether it was made or not.

#include "rodwake/assembly/measure_kind.hpp"

#include <span>

namespace rodwake::stages {

/// In the order of the file.
std::span<const assembly::SeriesInfo> series_columns();

} // namespace rodwake::stages
