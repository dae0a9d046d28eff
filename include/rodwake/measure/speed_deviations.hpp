#pragma once
// Large deviations of a rod's speed, from tracks: how often a rod that walks goes backwards for a while (N.
// Kumar, S. Ramaswamy & A. K. Sood, Phys. Rev. Lett. 106, 118001, 2011, arXiv 1009.5925). With X the
// displacement along the momentary heading n in the lag tau and v its mean over tau,
//
//   X = sum of dr . n,   W = X/(v tau),   F(W) = -ln P(W)/tau,   A(W) = F(W) - F(-W),   1/s,
//
// P the density of W (its integral is 1), so A has no constant that falls with tau. Bins are a third of the
// standard deviation of W wide, and come in pairs at +-W; starting times overlap. Where both bins of a pair
// hold at least 20 displacements, 5 of them outside any one run or block, A is known, and
//
//   A = slope W                                     weighted by the counts
//   A = linear W + cubic W^3                        the same; cubic 0: A is linear as far as one sees
//   (F(W) + F(-W))/2 = constant + W^2 curvature + |W| kink/2
//
// so kink is what F' gains at W = 0. For Gaussian X of mean v tau and variance 2 D tau slope is -v^2/D (< 0
// where going forwards is the more frequent), cubic and kink are 0, and P = sqrt(v^2 tau/(4 pi D)) exp(-v^2
// tau (W - 1)^2/(4 D)). `gaussian_slope`, -2/(tau var W), is the slope that a Gaussian of this variance has.
//
// Errors: jackknife over runs, or over blocks of time of all runs where there are fewer than eight runs. That
// of v is left out: it moves W and slope alike. Bins smear a Gaussian to a variance 1 + 1/108 times as large
// (slope 0.9 % too small); ln P of few displacements is biased by less than 1/(2 x 20) per bin.

#include "rodwake/core/estimate.hpp"
#include "rodwake/measure/heading_track.hpp"

#include <cstddef>
#include <span>

namespace rodwake::measure {

struct DeviationOptions {
    double block = 5.0; ///< s; each run is cut into whole ones, or is one itself
    double lag = 1.25;  ///< the longest, s; the others are a half, a quarter ... a 32nd of it

    bool operator==(const DeviationOptions&) const = default;
};

/// A pair of bins at +-W of one lag; the bin of -W in `minus`.
struct DeviationBin {
    double W;
    double plus, minus;             ///< displacements in them
    Estimate plus_rate, minus_rate; ///< F(W), F(-W), 1/s; count 0: too few
    Estimate antisymmetric;         ///< A(W), 1/s
};

struct DeviationLag {
    double lag = 0.0;                    ///< s
    double mean = 0.0, variance = 0.0;   ///< of W
    double backwards = 0.0;              ///< share of displacements below 0
    std::size_t pairs = 0;               ///< of bins in which A is known
    Estimate slope, linear, cubic, kink; ///< 1/s; count 0: fewer than 1, 3, 3, 4 pairs
    double gaussian_slope = 0.0;         ///< 1/s
    std::vector<DeviationBin> bins;      ///< from W = 0 up
};

struct SpeedDeviations {
    Estimate speed;                 ///< v, m/s
    std::vector<DeviationLag> lags; ///< from the shortest up
    std::size_t told = 0;           ///< the longest lag with a cubic and a kink; lags.size(): there is none
    std::size_t blocks = 0, parts = 0;
};

/// Throws InputError for options that are not positive, tracks shorter than twice the lag or a rod whose mean
/// speed is not above 0 by three errors (then W means nothing); RunError for tracks that are not evenly
/// spaced.
SpeedDeviations speed_deviations(std::span<const HeadingTrack> runs, const DeviationOptions& options);

} // namespace rodwake::measure
