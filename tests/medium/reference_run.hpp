#pragma once
// Rods in a dynamic medium, integrated in another way: all modes instead of half of them, one after the other
// in complex arithmetic, and the classical Runge-Kutta method with an integrating factor (Lawson, SIAM J.
// Numer. Anal. 4, 372, 1967) and a fixed step. Nothing but the problem's numbers is taken from the library.

#include "rodwake/medium/simulate.hpp"

#include <vector>

namespace rodwake::medium::tests {

/// Poses at problem.rods.t_end.
std::vector<double> reference_run(const MediumProblem& problem, long steps);

/// The same with problem.medium.inertia > 0: the classical Runge-Kutta method on amplitudes and their rates.
/// For steps well below those of the fastest wave.
std::vector<double> reference_waves(const MediumProblem& problem, long steps);

/// Largest difference of two states.
double distance(const std::vector<double>& a, const std::vector<double>& b);

/// Largest size of a value.
double largest(const std::vector<double>& values);

/// Poses of rods all over a box and beyond its sides, with all headings.
std::vector<double> crowd(std::size_t rods, double box);

} // namespace rodwake::medium::tests
