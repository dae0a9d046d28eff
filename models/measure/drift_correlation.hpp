#pragma once
// Correlations of a drift's deviations from its mean, and of a force with the drift before it, summed over
// blocks of time (formulas: rodwake/measure/drift_decay.hpp).

#include "rodwake/measure/drift_decay.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::measure {

/// Sums over starting times in a block; per lag in whole intervals, from 0.
struct DriftSums {
    std::vector<double> drift; ///< products of velocities, m^2/s^2
    std::vector<double> force; ///< of force and the earlier velocity, W; empty: no rods
    std::vector<double> pairs; ///< products that were added; two components count twice
};

struct DriftBlocks {
    double interval = 0.0;       ///< s
    double run_length = 0.0;     ///< mean of the runs, s
    std::vector<DriftSums> sums; ///< [block]; a last one below half the length is part of the one before
};

/// Lags up to `longest`, s. Paths have at least two points and one interval.
DriftBlocks drift_blocks(std::span<const DriftPath> runs, double longest, double block);

/// Means over all blocks but one; none is left out for without = blocks.size().
struct DriftCorrelation {
    std::vector<double> drift, force; ///< C, m^2/s^2, and K, W; [lag]
};
DriftCorrelation drift_correlation(std::span<const DriftSums> blocks, std::size_t without);

} // namespace rodwake::measure
