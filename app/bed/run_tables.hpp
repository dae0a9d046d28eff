#pragma once
// What a granular run wrote beside its frames, for the measures that are made from it.

#include "rodwake/app/measure_kind.hpp"

#include <filesystem>

namespace rodwake::app {

/// Read when they are asked for.
RunTables run_tables(const std::filesystem::path& folder);

} // namespace rodwake::app
