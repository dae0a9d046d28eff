#pragma once
// How the rods of a case end: outcome.json, and what the errors of a measured field make of it, by the same
// rods in fields drawn from it.

#include "rodwake/elastic/measured_field.hpp"
#include "rodwake/rods/simulate.hpp"
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

} // namespace rodwake::app
