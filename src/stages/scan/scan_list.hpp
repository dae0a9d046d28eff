#pragma once

#include "rodwake/assembly/scan.hpp"

namespace rodwake::stages {

/// The rows of scan.file, beside the scene or where the program runs; nothing for other designs. Throws
/// InputError with file:line for what is missing or wrong.
std::optional<assembly::ScanList> read_scan_list(const scene::Scene& scene);

} // namespace rodwake::stages
