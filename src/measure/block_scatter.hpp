#pragma once
// Standard errors of bins from what each block pulls a bin's value by.
//
//   error^2 = n/(n - 1) sum_b pull_b^2,   pull_b = w_b (v_b - mean)/sum w                  (as
//   mean_of_blocks)
//
// With few blocks such an error is itself uncertain by 1/sqrt(2 (n - 1)), and the ratio of a deviation to it
// has long tails. So it is mixed with what the whole field suggests for a bin of so many beads, s^2/count,
// as if that came from four more blocks. Correlation of successive blocks, of all bins together, then makes
// all errors larger by correlation_factor.

#include "bin_samples.hpp"
#include "block_sums.hpp"

#include <span>

namespace rodwake::measure {

/// How a part of the data stands to the one before it. Parts of one block that differ in the rod's heading
/// count as one value.
enum class Follows { nothing, block, same_block };

/// `before`: the part before it in the same run, if there is one.
Follows follows_of(const BlockSums* before, const BlockSums& now);

class BlockScatter {
public:
    /// Pulls of the parts of one bin in order of time and runs. Parts without data have pull 0 and are not
    /// present.
    void add(std::size_t bin, std::span<const Vector2> pulls, const std::vector<bool>& present,
             std::span<const Follows> follows);

    /// Writes sigma, blocks and block_correlation. Count must be there.
    void finish(BinSamples& samples) const;

    explicit BlockScatter(std::size_t bins) : squares_(bins), blocks_(bins) {}

private:
    void count(std::size_t bin, const Vector2& pull, const Vector2* last);
    Vector2 typical(const BinSamples& samples) const;

    std::vector<Vector2> squares_; ///< sums of pull^2
    std::vector<double> blocks_;
    double products_ = 0.0, product_squares_ = 0.0;
};

} // namespace rodwake::measure
