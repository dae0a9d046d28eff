#pragma once
// How fast a rod of a granular run forgets its heading, and how fast it walks meanwhile; from tracks
// (tracks.csv), not from frames. With d = theta(t0 + tau) - theta(t0), turns counted, a rod whose heading
// diffuses and besides rattles by a bounded angle of variance j^2 that is forgotten within the shortest lag
// has
//
//   <d^2>    = 2 j^2 + 2 D tau
//   <cos d>  = exp(-j^2) exp(-D tau)          for Gaussian changes (Howse et al., Phys. Rev. Lett. 99,
//   048102)
//
// D in rad^2/s. Each is fitted by a straight line in tau, the second by its logarithm, over lags from lag_low
// to lag_high with weights 1/tau^2; starting times overlap, changes are taken within blocks of time. Valid
// where D from the lower and from the upper half of the window agree (`early`, `late`: below and above its
// geometric mean). A rod that turns steadily at the rate w adds (w tau)^2 to <d^2>, which is not taken off:
// `turn_rate` tells. Errors are those of a jackknife over the runs, or over the blocks of all runs where
// there are fewer than eight runs; the interval is that of Student's t. The logarithm of a mean is biased by
// less than the square of its relative error; <d^2> is not biased.

#include "rodwake/core/estimate.hpp"
#include "rodwake/measure/heading_track.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::measure {

struct HeadingOptions {
    double block = 5.0;                      ///< s; each run is cut into whole ones, or is one itself
    double lag_low = 0.125, lag_high = 1.25; ///< s

    bool operator==(const HeadingOptions&) const = default;
};

struct HeadingDiffusion {
    Estimate diffusion;            ///< D from <d^2>, rad^2/s
    double low = 0.0, high = 0.0;  ///< its 95 % interval; NaN: unknown
    Estimate diffusion_cosine;     ///< D from <cos d>; count 0: it falls below 0.2 too soon
    Estimate early, late;          ///< D from <d^2> in the halves of the window
    double jitter = 0.0;           ///< j, rad; 0 where the line begins below 0
    Estimate turn_rate;            ///< mean of theta', rad/s
    Estimate speed;                ///< along the heading, m/s
    Estimate diffusion_per_length; ///< D over the speed, rad^2/m
    std::vector<double> lag;       ///< s, up to lag_high
    std::vector<double> square, square_error, cosine, cosine_error; ///< <d^2>, rad^2, and <cos d>
    std::vector<double> origins;                                    ///< starting times behind them
    double cosine_amplitude = 0.0;                                  ///< exp(-j^2) of the fit of <cos d>
    double lag_low = 0.0, lag_high = 0.0;                           ///< of the lags in the fits, s
    std::size_t blocks = 0, parts = 0; ///< parts: what the jackknife leaves out one by one
};

/// Throws InputError for options that are not positive or lag_low >= lag_high, tracks whose rows are so far
/// apart that fewer than 4 lags lie in the window, or shorter than twice lag_high. Where rows are not evenly
/// spaced (films), each two of them count at the lag they are nearest to, which then is the mean of theirs.
HeadingDiffusion heading_diffusion(std::span<const HeadingTrack> runs, const HeadingOptions& options);

} // namespace rodwake::measure
