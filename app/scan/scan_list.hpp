#pragma once

#include "rodwake/app/scan.hpp"

namespace rodwake::app {

/// The rows of scan.file, beside the scene or where the program runs; nothing for other designs. Throws
/// InputError with file:line for what is missing or wrong.
std::optional<ScanList> read_scan_list(const scene::Scene& scene);

} // namespace rodwake::app
