#pragma once
// Points of a scan evaluated by whoever a program hands them to: processes of a pool, nodes of a cluster.
// There each makes the plan anew from the scene and evaluates the points that it is sent; in the process that
// runs the scan RunContext::executor sends them and takes the results. Points and results are plain data
// (scan/point.hpp), and a result depends on scene and point alone.

#include "rodwake/app/run_context.hpp"
#include "rodwake/app/scan.hpp"

#include <filesystem>

namespace rodwake::app {

/// Evaluates points of this plan, which must outlive it; `context.stop` ends it early. Beds run in folders
/// below that of the scan, those of rods leave no files. Says nothing.
scan::Evaluate point_evaluator(const ScanPlan& plan, const std::filesystem::path& folder,
                               const RunContext& context);

} // namespace rodwake::app
