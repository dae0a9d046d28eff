#pragma once
// What the making of scans shares.

#include "rodwake/app/scan.hpp"

namespace rodwake::app {

/// Points are not asked for their way, only for its end.
void leave_out_outputs(std::optional<scene::RodsRun>& run);

/// What points do not need is left out: they are copied for each thread, and validated never.
scene::Scene scan_base(const scene::Scene& scene);

scan::Columns columns_of_rods(const scene::Scene& scene);

// Of a scan of beds.
scan::Columns columns_of_beds(const scene::Scene& scene);
/// Of a run at each place, in steps of a sphere; 0 where there is no such bed, which its point will tell.
std::vector<double> costs_of_beds(const ScanPlan& plan);

} // namespace rodwake::app
