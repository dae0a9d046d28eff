#pragma once
// The columns of series.csv: of the case, and of every measure, whether it was made or not.

#include "rodwake/app/measure_kind.hpp"

#include <span>

namespace rodwake::app {

/// In the order of the file.
std::span<const SeriesInfo> series_columns();

} // namespace rodwake::app
