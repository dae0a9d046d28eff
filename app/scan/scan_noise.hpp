#pragma once
// Points of a scan whose rods diffuse: each is an ensemble.

#include "rodwake/app/scan_problem.hpp"
#include "scan_values.hpp"

namespace rodwake::app {

/// All runs of a point on this thread: its outcome is the most frequent ending, its numbers those of run 0,
/// and behind them CaptureNumbers. Fails if a run does. False: options.ode.stop_requested stopped it.
bool evaluate_noisy(const ScanPlan& plan, const rods::RodProblem& problem, const rods::RodOptions& options,
                    const NoisePlan& noise, const OutputUnits& units, scan::Result& result);

/// Puts in CaptureNumbers of a point that has a single outcome for certain; nothing without [noise].
void store_certain_capture(const ScanPlan& plan, Ending ending, scan::Result& result);

} // namespace rodwake::app
