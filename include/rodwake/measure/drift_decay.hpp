#pragma once
// How fast the bed's own drift decays on the plates, and with how much inertia it does so.
//
//   m* M dV/dt = F(t) - zeta' V + noise      M, mass of the beads; V, velocity of their centre of mass;
//                                            F, force of the rods; zeta' = drag_rate M, drag of the plates, N
//                                            s/m
//   C(t) = <V(t0 + t) V(t0)>,   K(t) = <F(t0 + t) V(t0)>,   deviations from the mean of the run
//   m* [C(t1) - C(t2)] = drag_rate J - (1/M) int K dt,   J = int C dt,   both from t1 to t2 > t1 > 0
//   decay_rate = drag_rate/m*;  without F:  decay_rate = [C(t1) - C(t2)]/J, whatever drag_rate is
//
// Multiply the first line by V(t0) and average: noise knows nothing of earlier drifts (kicks of the plates).
// A steady push balances zeta' V and does not know the inertia, a decay does: so m* > 1 where a drift has to
// spin the beads too. A bead's spin follows its velocity within some 10 ms: C falls steeply there, and only
// later are V and spin one slow mode. So t1 = settle (30 ms); t2 is where C has fallen to C(t1)/e.
//
// V is the displacement over an interval h between frames: what the plates do within it is in it, at any
// phase. Integrals by the trapezoid, off by (decay_rate h)^2/12 in parts. F is that of the rods along their
// headings; with rods only the component of V along their push counts, since their force across it is not
// recorded.
//
// Bias: the mean of a run of length T, taken off, lowers C by c = 2 A/(decay_rate T), A e^(-decay_rate t) the
// slow part (to first order in 1/(decay_rate T)). Differences of C do not see it, J is put right by c (t2 -
// t1): some 2 % of the rate in runs of 30 s at 10/s. What the rods' force adds to A makes this too large by
// its share of C. Error: jackknife over blocks of time of all runs, t0 in the block; with that of drag_rate
// in squares. The least error of a run without rods is sqrt(decay_rate/T) (both components), twice that with
// the early lags left out. Domain: intervals of at most settle/2 and (with rods) rows of their force as
// dense; blocks of at least ten decays and at least hundred in all runs together, else no rate is given.

#include "rodwake/core/estimate.hpp"

#include <span>
#include <string>
#include <vector>

namespace rodwake::measure {

/// Of one run, at even times.
struct DriftPath {
    std::vector<double> time, x, y;           ///< centre of mass of the beads, unwrapped, s and m
    std::vector<double> impulse_x, impulse_y; ///< of the rods on the beads so far, N s; empty: no rods
};

struct DriftDecayOptions {
    double block = 5.0;   ///< s
    double settle = 0.03; ///< t1, s
};

struct DriftDecay {
    Estimate rate;                        ///< decay_rate, 1/s; count 0: not resolved
    Estimate inertia;                     ///< m*; count 0: drag_rate or the decay is not known
    double lag_low = 0.0, lag_high = 0.0; ///< t1, t2, s
    double coupling = 0.0; ///< int K dt/(M drag_rate J): part of the drag that the rods' force balances
    std::string absence;   ///< why there is no rate; empty: there is one
};

/// `mass` is M in kg; `drag_rate` by a steady push, 1/s, count 0: not known (needed with rods). Throws
/// InputError for options that are not positive or rows of different lengths.
DriftDecay drift_decay(std::span<const DriftPath> runs, double mass, const Estimate& drag_rate,
                       const DriftDecayOptions& options);

} // namespace rodwake::measure
