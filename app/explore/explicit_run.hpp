#pragma once
// Any number of rods by an explicit method, without SUNDIALS.

#include "rodwake/core/error.hpp"
#include "rodwake/rods/simulate.hpp"

#include <functional>

namespace rodwake::app {

/// The equations of a problem in the exact field on the plane, each wake by itself: without the sums over
/// many rods of elastic/mutual_wakes.hpp, which need threads and would be most of the page.
rods::RodModel model_on_plane(const rods::RodProblem& problem);

RunError too_stiff(long attempts, double time);

/// Receives the time, the state and its rates at the start and after each step.
using OnRow = std::function<void(double time, integrate::State y, integrate::State rates)>;

/// Dormand-Prince 5(4) with the tolerances, step limit and endings of rods::simulate. Throws InputError as
/// that does, RunError for rods that pass through each other and after `max_attempts` steps.
rods::RodOutcome explicit_run(const rods::RodProblem& problem, double rtol, long max_attempts,
                              const OnRow& on_row);

} // namespace rodwake::app
