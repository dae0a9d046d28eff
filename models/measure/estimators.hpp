#pragma once
// What an estimator knows of each bin of the grid before its values are taken to the grid's middles.

#include "rodwake/measure/displacement.hpp"

#include <span>
#include <vector>

namespace rodwake::measure {

struct BinSamples {
    std::vector<Vector2>
        place; ///< mean place of the beads, in the rod's frame, displaced or not (see maker), m
    std::vector<Vector2> value; ///< displacement there, m
    std::vector<Vector2> sigma; ///< standard error, m
    std::vector<double> count, coherence;
    std::vector<double> blocks; ///< with data in the bin
    double block_correlation = 0.0;

    explicit BinSamples(std::size_t bins)
        : place(bins), value(bins), sigma(bins), count(bins), coherence(bins), blocks(bins) {}
};

// Displacement in each bin from the sums of exp(i G_k.r) of all blocks of all runs, whose lattices and
// headings may differ.
//
//   U maximises sum_b sum_k Re[ Z_bk exp(-i g_bk.U) ],   Z_bk the sum over the block's beads in the bin,
//                                                        g_bk its wave vector along the rod's axes
//
// That is the likelihood of phases that scatter around g.U (von Mises). It needs no phase of a single block,
// so bins with few beads are as unbiased as others. It starts from the unwrapped phases of the largest set of
// blocks with one lattice and nearly one heading.

/// Places are where the beads were (displaced). Throws RunError without a crystal: the
/// largest peak of each run with frames must be at least 20 times the ring's mean. All accumulators of one
/// estimator, phase or density, with frames in at least one.
BinSamples phase_samples(std::span<const DisplacementAccumulator> runs);

// Mean displacement in each bin over the blocks of all runs, a block counting by its beads.

/// Places are where the beads were before the rod came. All accumulators of the estimator lagrangian.
BinSamples lagrangian_samples(std::span<const DisplacementAccumulator> runs);

} // namespace rodwake::measure
