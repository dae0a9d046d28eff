#pragma once
// The files of [rods_order]: rods_order.csv, clusters.csv, rods_order.json.

#include "rodwake/measure/rod_order.hpp"
#include "run/session.hpp"

#include <vector>

namespace rodwake::app {

/// [rods_order] of a case, in the units of its files.
struct OrderKeys {
    double link = 0.0, from = 0.0, block = 0.0;
    std::optional<PeriodicBox> box; ///< the periodic one; absent: infinite plane
    OutputUnits units;

    explicit OrderKeys(const scene::Scene& scene);
};

/// Of all runs of a case, one for rods of the theory; nothing but a warning if all ended before
/// rods_order.from.
void write_rods_order(const Session& session, const Case& of, const OrderKeys& keys,
                      const std::vector<measure::RodOrderSeries>& runs);

} // namespace rodwake::app
