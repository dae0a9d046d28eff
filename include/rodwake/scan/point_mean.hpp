#pragma once
// What the runs of a point yield together: means with errors, shares of outcomes, failures counted.

#include "rodwake/core/estimate.hpp"
#include "rodwake/scan/ledger.hpp"
#include "rodwake/scan/proportion.hpp"

namespace rodwake::scan {

struct PointMean {
    Point point;                       ///< its id is its place
    std::int64_t runs = 0, failed = 0; ///< that finished, and that failed
    Status status = Status::ok;        ///< ok if a run finished, else that of the first
    std::int32_t outcome = -1;         ///< the most frequent one, of equals the first; -1: no run finished
    std::vector<Proportion> outcomes;  ///< of the runs that finished, as Columns::outcomes
    std::vector<Estimate> values;      ///< over the runs that have the number, as Columns::observables
};

/// Of the results of one place, in the order of their runs. Throws InputError for none.
PointMean mean_of_runs(std::span<const Result> runs, const Columns& columns);

/// Of every place that the ledger of a repeated design holds, in their order.
std::vector<PointMean> means_of(const Ledger& ledger);

} // namespace rodwake::scan
