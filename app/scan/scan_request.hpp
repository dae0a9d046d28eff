#pragma once
// What a scan is asked for beside its scene, and what is there already: seen before anything is written.

#include "rodwake/app/run_context.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/scan/ledger.hpp"

#include <filesystem>
#include <vector>

namespace rodwake::app {

scan::LedgerHead ledger_head(const ScanPlan& plan);

/// The ledgers of the shares below the folder of a scan.
std::vector<std::filesystem::path> shares_in(const std::filesystem::path& folder);

/// Throws InputError for shares of an adaptive scan, for a merge without shares, and for ledgers in the
/// folder or of its shares that are of another scan, of a newer version, or damaged.
void require_scan(const ScanPlan& plan, const std::filesystem::path& folder, const RunContext& context);

/// The rows of scan.file, beside the scene or where the program runs; nothing for other designs. Throws
/// InputError with file:line for what is missing or wrong.
std::optional<ScanList> read_scan_list(const scene::Scene& scene);

} // namespace rodwake::app
