#pragma once
// Mean-square displacements of the beads against the lag, and the jackknife by which every curve made of them
// gets its errors.

#include "rodwake/measure/microrheology.hpp"

#include <span>
#include <vector>

namespace rodwake::measure {

using MicrorheologyRuns = std::span<const MicrorheologyAccumulator>;

struct Lag {
    std::size_t level, channel;
    std::size_t frames() const { return (channel + 1) << level; }
};

/// Starting times behind a lag of a run.
double origins(const MicrorheologyAccumulator& run, Lag lag);

/// Lags that every run has.
std::vector<Lag> common_lags(MicrorheologyRuns runs);

/// The lags, in seconds, that have at least a quarter of the time origins of their run, in every run: beyond,
/// the mean-square displacement is that of hardly more than one stretch of time. Throws InputError for fewer
/// than 2.
std::vector<double> well_known(MicrorheologyRuns runs, const std::vector<Lag>& lags,
                               const std::vector<double>& seconds);

/// Sums of |dx|^2 and what they are over, [lag]; a run, or one group of beads of a run.
struct LagBlock {
    std::vector<double> sum, weight;
};

/// Whole runs if there are at least 4, else groups of beads of each run.
std::vector<LagBlock> all_blocks(MicrorheologyRuns runs, const std::vector<Lag>& lags);

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

/// Evenly spaced in the logarithm, both ends included.
std::vector<double> log_range(double low, double high, std::size_t points);

} // namespace rodwake::measure
