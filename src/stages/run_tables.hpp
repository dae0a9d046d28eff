#pragma once
// What a granular run wrote beside its frames, for the measures that are made from it.

#include "rodwake/assembly/measure_kind.hpp"

#include <filesystem>

namespace rodwake::stages {

/// Read when they are asked for.
assembly::RunTables run_tables(const std::filesystem::path& folder);

} // namespace rodwake::stages
