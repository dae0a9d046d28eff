#pragma once
// Rods that diffuse: the equations of model.hpp with additive white noise, independent for each rod,
//
//   d theta_a = (...) dt + sqrt(2 D_r) dW_theta,   d(x, y)_a = (cos theta_a, sin theta_a) dt + sqrt(2 D_t) dW
//
// D_r in rad^2 mu v0/f, D_t in f v0/mu. A free rod (Howse et al., Phys. Rev. Lett. 99, 048102 (2007), v0 =
// 1):
//
//   <cos(theta(t) - theta(0))> = exp(-D_r t)
//   <|r(t) - r(0)|^2> = (2/D_r^2)(D_r t - 1 + exp(-D_r t)) + 4 D_t t
//
// Each span between output times is halved until no step is longer than `time_step`; within that, steps are
// halved where rods come near each other or turn fast (step_limit in noise.cpp). All steps of a run follow
// one Brownian path, whatever their length: the increments of a span are drawn first, those of its halves
// given them (integrate/additive_noise.hpp). Every number depends on (seed, run, rod, span, place in the
// halving) alone.
//
// Contact. With D_t = 0 separations are smooth: a step at whose end, or on whose cubic, two rods are in
// contact is halved to 1e-4, and the time found on the cubic. With D_t > 0 the separation of a pair is a
// diffusion of strength s^2 = 4 D_t, and two rods that are d0 > 0 and d1 > 0 short of contact at the ends of
// a step of length h have met in between with the probability exp(-2 d0 d1/(s^2 h)) (Brownian bridge), which
// is drawn; the time of the first meeting has the law tau/(h - tau) ~ inverse Gaussian of mean d0/|d1| and
// shape d0^2/(s^2 h). The bridge takes the circle of contact for its tangent and the drift along the step for
// constant; steps are short enough for that near contact (docs/noise.md has the error measured).
//
// Errors (docs/noise.md, Accuracy): strong order 1.5, weak order 2.1 +- 0.2 (build/dev/tests/test_rods); the
// bridge's probability of contact within 2 % of itself (studies/validate_noise.py --only passage).
//
// Degenerate input:
//   D_r = D_t = 0                                     the equations of motion
//   D < 0, infinite or NaN; time_step <= 0 or NaN     InputError
//   time_step infinite                                steps as long as spans and relaxation allow
//   coincident rods                                   InputError; contact at 0 with a contact distance
//   2^24 output times or more                         InputError
//   a field that fails on the way                     a failed run, with the reason

#include "rodwake/rods/simulate.hpp"

#include <cstdint>

namespace rodwake::rods {

struct Noise {
    double rotational = 0.0;    ///< D_r
    double translational = 0.0; ///< D_t, along each axis
    double time_step = 0.0;     ///< longest step, > 0
    std::uint64_t seed = 1;
};

/// 0.05 of the shortest of 1 (in f/(mu v0), in which a rod walks f/mu), 1/D_r and 1/k, where k is the fastest
/// rate at which a heading can relax in the wakes of the start.
double suitable_time_step(const RodProblem& problem, double rotational);

/// Ends of noisy runs, and of those without noise among them: headings wander as those of a bed's rods do.
inline constexpr EndingCriteria noisy_criteria = noisy_track;

/// Run `run` of the ensemble, of the form angle; of the options only criteria, max_steps, stop_requested and
/// on_step count. The separations of the record are those at step ends and on cubics between them. Throws as
/// simulate() does, and for a noise that is negative or without step; a failed run is a value. Thread-safe.
RodResult simulate(const RodProblem& problem, const RodOptions& options, const Noise& noise,
                   std::uint32_t run);

} // namespace rodwake::rods
