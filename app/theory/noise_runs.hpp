#pragma once
// Ensembles of rods that diffuse: done run by run, taken up again where they stopped, and their files.

#include "rodwake/rods/noise_ensemble.hpp"
#include "rodwake/scan/proportion.hpp"
#include "run/session.hpp"

#include <string>

namespace rodwake::app {

/// The runs of a case on all threads; goes on from noise_progress.json. False: stopped on the way, and what
/// was done is kept there. `field`: what tells the problem's field beside its scene.
bool run_noise(const Session& session, const RodsPlan& plan, const rods::RodProblem& problem,
               const std::string& field, rods::NoiseSums& sums);

/// Runs that end in contact or pursuit, of those that did not fail; of a single rod none are tried.
scan::Proportion captured(const rods::NoiseSums& sums, std::size_t rods);
/// Of its Wilson interval of 95 %.
inline constexpr double capture_quantile = scan::quantile_95;

/// Contents of noise.json and ensemble.csv, in output units.
std::string noise_json(const rods::NoiseSums& sums, const NoisePlan& plan, const rods::RodProblem& problem,
                       const OutputUnits& units);
std::string noise_csv(const rods::NoiseSums& sums, std::size_t rods, const OutputUnits& units);

} // namespace rodwake::app
