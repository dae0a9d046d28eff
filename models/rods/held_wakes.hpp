#pragma once
// Rods with bodies in two kinds of steps: short ones for contacts, long ones for wakes, held meanwhile.

#include "rodwake/rods/simulate.hpp"

namespace rodwake::rods {

/// As integrate::solve(ode, ...) with the right-hand side g + W, where W are the turning rates in the wakes
/// and g all others. A long step H from t holds them twice, at W1 = W(t, y) and W2 = W(t + H/2, y):
///
///   y' = g(y) + W1           from t to t + H/2
///   y' = g(y) + 2 W2 - W1    from t + H/2 to t + H
///
/// which is of second order in H (MRI-GARK-ERK22a of Sandu, SIAM J. Numer. Anal. 57 (2019) 2300; each line is
/// solved to the tolerances by ode's method). The local error of the headings is H^3 W''/24; it is estimated
/// from what W2 is off the line through the two W before it, and sets the next H, at most `longest`(t, y): a
/// step is never taken again. Segments are of long steps.
integrate::Solution solve_with_held_wakes(const integrate::OdeProblem& ode, const StateRates& wakes,
                                          const StateRates& others,
                                          const std::function<double(double, integrate::State)>& longest,
                                          const integrate::OdeOptions& options,
                                          std::span<const double> times);

} // namespace rodwake::rods
