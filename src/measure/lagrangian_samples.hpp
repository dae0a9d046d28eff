#pragma once
// Mean displacement in each bin over the blocks of all runs, a block counting by its beads.

#include "bin_samples.hpp"
#include "displacement_impl.hpp"

#include <span>

namespace rodwake::measure {

/// Places are where the beads were before the rod came. All records of the estimator lagrangian.
BinSamples lagrangian_samples(std::span<const DisplacementRecord> runs);

} // namespace rodwake::measure
