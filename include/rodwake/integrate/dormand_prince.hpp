#pragma once
// Dormand-Prince 5(4) (Hairer, Norsett, Wanner I, table II.5.2) for those who take its steps themselves: the
// batched pairs of rods and the page of rodwake explore.

namespace rodwake::integrate {

/// Of the rates of earlier stages; the last stage is the step's end.
inline constexpr double stage_weights[7][6] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
inline constexpr double error_weights[7] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                            -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

} // namespace rodwake::integrate
