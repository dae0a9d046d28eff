#pragma once
// Sums in the bins of a RodGrid, one set a block of time. A new block begins when time/length passes a whole
// number or the rod is turned by more than 0.1 rad from where it was at the beginning of each block of that
// time: one that rattles about a heading does not make a block each time.

#include "estimators.hpp"
#include "rodwake/measure/microrheology.hpp"
#include "rodwake/measure/state_io.hpp"

#include <optional>
#include <span>
#include <vector>

namespace rodwake::measure {

struct BlockSums {
    double number = 0.0;             ///< floor(time/length)
    double first_heading = 0.0;      ///< rad
    double cosine = 0.0, sine = 0.0; ///< sums of those of the heading
    double frames = 0.0;
    std::vector<double> sums; ///< [bin][channel]

    /// Mean heading, rad.
    double heading() const;
};

class Blocks {
public:
    Blocks(std::size_t bins, std::size_t channels, double length)
        : bins_(bins), channels_(channels), length_(length) {}

    /// The block this frame belongs to, with the frame counted in.
    BlockSums& at(double time, double heading);

    std::span<const BlockSums> all() const { return blocks_; }
    /// Of a block by its place in all(); changes no count of frames.
    std::vector<double>& sums(std::size_t block) { return blocks_[block].sums; }
    std::size_t channels() const { return channels_; }
    void save(StateWriter& out) const;
    void load(StateReader& in);

private:
    std::size_t bins_, channels_;
    double length_;
    std::vector<BlockSums> blocks_;
};

// Standard errors of bins from what each block pulls a bin's value by.
//
//   error^2 = n/(n - 1) sum_b pull_b^2,   pull_b = w_b (v_b - mean)/sum w                  (as
//   mean_of_blocks)
//
// With few blocks such an error is itself uncertain by 1/sqrt(2 (n - 1)), and the ratio of a deviation to it
// has long tails. So it is mixed with what the whole field suggests for a bin of so many beads, s^2/count,
// as if that came from four more blocks. Correlation of successive blocks, of all bins together, then makes
// all errors larger by correlation_factor.

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
    std::vector<Vector2> squares_; ///< sums of pull^2
    std::vector<double> blocks_;
    double products_ = 0.0, product_squares_ = 0.0;
};

// Mean-square displacements of the beads against the lag, and the jackknife by which every curve made of them
// gets its errors.

using MicrorheologyRuns = std::span<const MicrorheologyAccumulator>;

/// Keys of the lags that every run has, rising.
std::vector<long> common_lags(MicrorheologyRuns runs);

/// The lags, in seconds, up to the first that is not well known in every run: beyond, the mean-square
/// displacement is that of hardly more than one stretch of time. Throws InputError for fewer than 2.
std::vector<double> well_known(MicrorheologyRuns runs, const std::vector<long>& lags);

/// Sums of |dx|^2 and what they are over, [lag]; a run, or one group of beads of a run.
struct LagBlock {
    std::vector<double> sum, weight;
};

/// Whole runs if there are at least 4, else groups of beads of each run.
std::vector<LagBlock> all_blocks(MicrorheologyRuns runs, const std::vector<long>& lags);

/// Mean-square displacements of all blocks, or of all but one.
std::vector<double> pooled(const std::vector<LagBlock>& blocks, std::size_t without);

/// The same curve of all blocks together and with each left out in turn.
struct Jackknife {
    std::vector<double> all;
    std::vector<std::vector<double>> without;

    template<class Function>
    static Jackknife of(const std::vector<LagBlock>& blocks, const Function& function) {
        Jackknife curves{function(pooled(blocks, blocks.size())), {}};
        for (std::size_t b = 0; b < blocks.size(); ++b)
            curves.without.push_back(function(pooled(blocks, b)));
        return curves;
    }
    double error(std::size_t i) const;
    std::vector<double> errors() const;
};

/// What a camera's errors add to every displacement, m^2 (microrheology.hpp); nothing where the first six
/// lags, of which the blocks' first six are those, do not tell it from the beads' own motion.
std::optional<Estimate> camera_noise(const std::vector<LagBlock>& blocks);

/// So much of every displacement, m^2.
void take_off(std::vector<LagBlock>& blocks, double added);

/// Evenly spaced in the logarithm, both ends included.
std::vector<double> log_range(double low, double high, std::size_t points);

} // namespace rodwake::measure
