#pragma once
// Runge-Kutta pair of orders 6(5) with nine stages, the last of which is the first of the next step
// (Ch. Tsitouras & I. Th. Famelis, Phase-fitted modified Runge-Kutta pairs of orders 6(5), ICNAAM 2006; here
// without phase fitting). Pairs of rods take 0.71 (rtol 1e-6) to 0.6 (1e-9) of the right-hand sides of
// Dormand-Prince 5(4) at equal error; six other pairs of orders 6(5) take more.

#include <cmath>
#include <cstddef>

namespace rodwake::integrate::tsitouras_famelis {

inline constexpr std::size_t stages = 9;
inline constexpr int order = 6;

/// How much larger than the tolerance the estimate of a step's error may be, for the errors over rtol of
/// Dormand-Prince's steps (pairs of rods, studies/reports/rods.md). `most`: of loose tolerances.
inline double leniency(double rtol, double most) {
    const double more = 4.0 + 10.0 * std::sqrt(1e6 * rtol);
    return more < most ? more : most;
}

/// Where the stages are in the step.
inline constexpr double nodes[stages] = {
    0.0, 0.09289617486338798, 0.14457831325301204, 0.21686746987951808, 0.568, 0.711864406779661, 0.995, 1.0,
    1.0};

/// Of the rates of earlier stages; the last stage is the step's end, of order 6.
inline constexpr double stage_weights[stages][stages - 1] = {
    {},
    {0.09289617486338798},
    {0.032071588978166386, 0.11250672427484566},
    {0.05421686746987952, 0.0, 0.16265060240963855},
    {0.656598126617284, 0.0, -2.4972770465185183, 2.4086789199012344},
    {-1.7212338830272755, 0.0, 7.223107511920211, -5.4959191727393515, 0.7059099506260772},
    {4.128671897161615, 0.0, -16.91402530428944, 14.328981321740587, -1.553355090373531, 1.004727175760767},
    {4.468607842844296, 0.0, -18.34544186942965, 15.52377072335432, -1.7228800213316942, 1.0815157174021452,
     -0.005572392839416983},
    {0.06423090937210832, 0.0, 0.0, 0.3328618246994211, 0.2678592291657781, 0.17986389967093872,
     1.5107578480576216, -1.3555737109658679}};

/// Of the difference from the solution of order 5.
inline constexpr double error_weights[stages] = {0.0019328139549844403,
                                                 0.0,
                                                 0.0,
                                                 -0.007341694936362561,
                                                 0.03186168780166909,
                                                 -0.040776376725103806,
                                                 0.36031650852893243,
                                                 -0.35265960529078627,
                                                 0.006666666666666667};

} // namespace rodwake::integrate::tsitouras_famelis
