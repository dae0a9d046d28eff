#pragma once
// Points of a scan whose rods diffuse: each is an ensemble.

#include "rodwake/assembly/scan_problem.hpp"
#include "scan_values.hpp"

namespace rodwake::stages {

/// All runs of a point on this thread: its outcome is the most frequent ending, its numbers those of run 0,
/// and behind them assembly::captures. Fails if a run does. False: options.ode.stop_requested stopped it.
bool evaluate_noisy(const assembly::ScanPlan& plan, const rods::RodProblem& problem,
                    const rods::RodOptions& options, const assembly::NoisePlan& noise,
                    const assembly::OutputUnits& units, scan::Result& result);

/// Puts in assembly::captures of a point that has a single outcome for certain; nothing without [noise].
void store_certain_capture(const assembly::ScanPlan& plan, Ending ending, scan::Result& result);

} // namespace rodwake::stages
