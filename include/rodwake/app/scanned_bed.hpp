#pragma once
// Points of a scan of beds: the bed of each, and what a finished run of it yields.

#include "rodwake/app/measure_kind.hpp"
#include "rodwake/app/plan.hpp"

#include <cstdint>
#include <vector>

namespace rodwake::app {

/// The bed of a point. Throws InputError for one that cannot be modelled.
BedPlan scanned_bed(const ScanPlan& plan, const scan::Point& point);

struct BedYield {
    std::int32_t outcome = 0;   ///< index into Columns::outcomes
    std::vector<double> values; ///< as Columns::observables
};

/// From what the run wrote: lengths in a, the rest SI. Throws InputError for files that are not of such a
/// run.
BedYield yield_of(const scene::Scene& scene, const RunTables& run);

} // namespace rodwake::app
