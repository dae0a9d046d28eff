#pragma once
// How the rods of a case end: outcome.json, and what the errors of a measured field make of it, by the same
// rods in fields drawn from it.

#include "rodwake/elastic/measured_field.hpp"
#include "rodwake/rods/noise_ensemble.hpp"
#include "rodwake/rods/simulate.hpp"
#include "rodwake/scan/proportion.hpp"
#include "run/session.hpp"
#include "theory_records.hpp"

#include <string>
#include <vector>

namespace rodwake::app {

/// Runs `samples` draws over the threads; results do not depend on their number. Empty if stopped on the way.
std::vector<rods::RodResult> run_ensemble(const rods::RodProblem& problem, const rods::RodOptions& options,
                                          const elastic::MeasuredDisplacement& measured,
                                          const scene::MeasuredMedium& keys, const RunContext& context);

/// ensemble.csv: a row a sample.
std::string ensemble_csv(const std::vector<rods::RodResult>& samples, rods::Box box,
                         const OutputUnits& units);

/// For outcome.json: how many samples ended how, mean and spread of separations and times. The spread, a
/// standard deviation, is the standard error that the field's errors give the central result.
DrawnReport drawn_report(const std::vector<rods::RodResult>& samples, rods::Box box,
                         const OutputUnits& units);

/// Content of outcome.json. Lengths and times in output units.
std::string outcome_json(const rods::RodResult& result, const RodsPlan& plan, const OutputUnits& units,
                         const std::optional<DrawnReport>& ensemble,
                         const std::vector<double>& own_turn = {});

/// Places of all samples at the output times into `group` of the results: x, y as [sample][time][rod], NaN
/// where a sample has ended.
void store_ensemble(store::Hdf5Writer& results, const std::string& group,
                    const std::vector<rods::RodResult>& samples, const std::vector<double>& times,
                    const OutputUnits& units);

// Ensembles of rods that diffuse: done run by run, taken up again where they stopped, and their files.

/// The runs of a case on all threads; goes on from noise.log. False: stopped on the way, and what
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

/// Bodies of a case into `group` of the results, body/spheres, body/length, ... a number a rod, and the sides
/// of its periodic box as box.
void store_bodies(store::Hdf5Writer& results, const std::string& group, const rods::RodProblem& problem,
                  const OutputUnits& units);

} // namespace rodwake::app
