#pragma once
// Points of a scan of beds: each is one granular run in a folder of its own, from which a run that was
// stopped goes on.

#include "bed/granular_jobs.hpp"
#include "rodwake/app/scanned_bed.hpp"

namespace rodwake::app {

/// The folder of a run, below that of the scan: points/<point>/runs/<run>, both from 1.
std::filesystem::path bed_folder(const std::filesystem::path& scan, std::int64_t id);

/// The run whose file it is, seen from the folder of the scan; nothing for other files.
std::optional<std::int64_t> bed_of(const std::filesystem::path& file);

/// Runs points of a plan, which must outlive it, below this folder. What fails is not tried again with other
/// settings: a smaller step is another bed. One whose time is up keeps its checkpoint, and so goes on when it
/// is evaluated again.
scan::Evaluate evaluate_beds(const ScanPlan& plan, std::filesystem::path folder, RunContext context,
                             Logger log);

} // namespace rodwake::app
