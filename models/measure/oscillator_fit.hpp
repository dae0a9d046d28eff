#pragma once
// The velocity correlation of a damped oscillator in white noise, fitted to a correlation at even lags.
//
//   u'' + gamma u' + omega^2 u = noise,   Omega^2 = omega^2 - gamma^2/4 of either sign
//   C(t) = A exp(-gamma t/2) [cos(Omega t) - gamma/(2 Omega) sin(Omega t)]          (Omega^2 < 0: cosh, sinh)
//
// Chandrasekhar, Rev. Mod. Phys. 15, 1 (1943), eqs. 190 to 216. Times in s, omega and gamma in 1/s, t >= 0.

#include <span>
#include <vector>

namespace rodwake::measure {

struct Oscillator {
    double omega = 0.0; ///< of the oscillator without damping, 1/s
    double gamma = 0.0; ///< rate at which its velocity is damped, 1/s
};

/// C(t)/A at t = 0, step, 2 step, ...; exact to rounding, by the recurrence that evenly spaced values obey.
std::vector<double> oscillator_correlation(const Oscillator& o, double step, std::size_t lags);

/// Rate at which the slower part of C(t) decays, 1/s.
double slow_rate(const Oscillator& o);

struct OscillatorFit {
    Oscillator oscillator;
    double amplitude = 0.0;
};

/// Lags of C that the fit should go by: until what is left of it is e^-3, at least 10, at most all.
std::size_t fitted_lags(const Oscillator& o, double step, std::size_t lags);

/// Least squares over the lags [1, size), all of equal weight; lag 0 also holds what single particles do.
/// From the best point of a grid, or from `start`. Of fewer than 6 lags, or of what is nowhere like such an
/// oscillator, omega and gamma are NaN.
OscillatorFit fit_oscillator(std::span<const double> correlation, double step,
                             const Oscillator* start = nullptr);

} // namespace rodwake::measure
