#pragma once
// Points of a scan of rods: each is one encounter.

#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan.hpp"

#include <functional>

namespace rodwake::app {

/// Evaluates points of a plan, which must outlive it. A point whose rods start within the contact distance
/// is a contact at time 0. One that fails is tried again: with ten times the steps, with a
/// tenth of the tolerance, with the other kind of method; what was tried is in its cause. Times and lengths
/// in output units. With noise a point is an ensemble.
scan::Evaluate evaluate_rods(const ScanPlan& plan, std::function<bool()> stop);

/// The encounter of a point with `times` output times spread over [0, end], as run for its result; with
/// noise another run of its ensemble's law.
rods::RodResult trajectory_of(const ScanPlan& plan, const scan::Result& result, std::size_t times);

} // namespace rodwake::app
