#pragma once
// What an estimator knows of each bin of the grid before its values are taken to the grid's middles.

#include "rodwake/measure/displacement.hpp"

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

} // namespace rodwake::measure
