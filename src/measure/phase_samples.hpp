#pragma once
// Displacement in each bin from the sums of exp(i G_k.r) of all blocks of all runs, whose lattices and
// headings may differ.
//
//   U maximises sum_b sum_k Re[ Z_bk exp(-i g_bk.U) ],   Z_bk the sum over the block's beads in the bin,
//                                                        g_bk its wave vector along the rod's axes
//
// That is the likelihood of phases that scatter around g.U (von Mises). It needs no phase of a single block,
// so bins with few beads are as unbiased as others. It starts from the unwrapped phases of the largest set of
// blocks with one lattice and nearly one heading.

#include "bin_samples.hpp"
#include "displacement_impl.hpp"

#include <span>

namespace rodwake::measure {

/// Places are where the beads were (displaced). Throws RunError without a crystal. All records of one
/// estimator, phase or density, with frames in at least one.
BinSamples phase_samples(std::span<const DisplacementRecord> runs);

/// Throws RunError unless the largest peak of each run with frames is at least 20 times the ring's mean.
void want_crystal(std::span<const DisplacementRecord> runs);

} // namespace rodwake::measure
