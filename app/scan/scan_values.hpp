#pragma once
// What a point of rods yields: how the encounter ended, and the numbers of its row.

#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <vector>

namespace rodwake::app {

/// How far rod 0 had come ahead of rod 1 since the start, when the pair had turned most.
struct Ahead {
    double x = 0.0, y = 0.0;
};

/// Follows a pair step by step to find that: then the other rod is the rear one, as measure/pairs.hpp says
/// for tracks.
class Leader {
public:
    explicit Leader(const rods::RodProblem& problem) : first_(rods::to_state(problem.rods)) {}

    void add(integrate::State y);
    Ahead ahead() const { return ahead_; }

private:
    std::vector<double> first_;
    double most_ = 0.0;
    Ahead ahead_;
};

/// Reduced units.
struct EncounterEnd {
    Ending ending = Ending::undecided;
    double time = 0.0, min_separation = 0.0, min_separation_time = 0.0;
    std::vector<double> turn;
    double non_reciprocity = 0.0; ///< NaN: there is none
    double separation = 0.0;      ///< at the end; of more rods of the pair that the outcome is about
    double angle = 0.0;           ///< between the headings, likewise
    long steps = 0, rhs_evaluations = 0;
};

EncounterEnd end_of(const rods::RodProblem& problem, const rods::RodResult& run, const Ahead& ahead);
EncounterEnd end_of(const rods::PairProblem& pair, const rods::PairResult& run);

/// Into the columns of the plan, in output units; a number that is not finite makes the point fail.
void store(const EncounterEnd& end, const ScanPlan& plan, const OutputUnits& units, scan::Result& result);

} // namespace rodwake::app
