#pragma once
// What a point of rods yields: how the encounter ended, and the numbers of its row.

#include "rodwake/app/rods.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/core/record.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <cmath>
#include <span>
#include <vector>

namespace rodwake::app {

/// How far rod 0 had come ahead of rod 1 since the start, when the pair had turned most.
struct RelativeDisplacement {
    double x = 0.0, y = 0.0;
};

/// Follows a pair step by step to find that: then the other rod is the rear one, as measure/pairs.hpp says
/// for tracks.
class FrontRodTracker {
public:
    explicit FrontRodTracker(const rods::RodProblem& problem) : first_(rods::to_state(problem.rods)) {}
    /// As a run of a batch left it.
    FrontRodTracker(const rods::RodProblem& problem, const rods::PairResult& run)
        : first_(rods::to_state(problem.rods)),
          most_(std::abs(run.turn[0]) + std::abs(run.turn[1])), ahead_{run.ahead_x, run.ahead_y} {}

    void add(integrate::State y);
    RelativeDisplacement ahead() const { return ahead_; }

private:
    std::vector<double> first_;
    double most_ = 0.0;
    RelativeDisplacement ahead_;
};

inline constexpr std::string_view certificate_column = "certificate";

/// Reduced units.
struct EncounterEnd {
    Ending ending = Ending::undecided;
    double time = 0.0, min_separation = 0.0, min_separation_time = 0.0;
    std::vector<double> turn;
    double non_reciprocity = 0.0; ///< NaN: there is none
    double separation = 0.0;      ///< of more rods of the pair that the outcome is about
    double angle = 0.0;           ///< likewise
    long steps = 0, rhs_evaluations = 0;
    double certificate = 2.0;                   ///< number of the Certificate; a word in scan.csv
    rods::Separation pair{};                    ///< of which the outcome tells
    double orbit_separation = NAN, omega = NAN; ///< of an orbit
    std::string failed{};                       ///< RodOutcome::failed

    static constexpr auto fields() {
        using R = EncounterEnd;
        return std::tuple{
            field("time", &R::time, {"{scan time}", "of contact, else the end of the run"}),
            field("min_separation", &R::min_separation, {"{scan length}", "smallest separation of two rods"}),
            field("min_separation_time", &R::min_separation_time,
                  {"{scan time}", "when the separation was smallest"}),
            field(
                "turn", &R::turn,
                {"rad", "of the rod from start to end; in beds + is towards the other rod's first position"}),
            field("non_reciprocity", &R::non_reciprocity,
                  {"1", "(|turn of the rear| - |turn of the front|)/(their sum)"}),
            field("final_separation", &R::separation, {"{scan length}", "at the end"}),
            field("final_angle", &R::angle, {"rad", "between the headings at the end"}),
            field("steps", &R::steps, {"1", "of the solver"}),
            field("rhs_evaluations", &R::rhs_evaluations, {"1", "of the right-hand side"}),
            field("separation", &R::orbit_separation,
                  {"{scan length}", "of rods in an orbit, else empty; of beds at the start"}),
            field("omega", &R::omega,
                  {"rad/({scan time})", "turning rate of an orbit, + counterclockwise (empty: none)"}),
            field(certificate_column, &R::certificate,
                  {"1", "how well the outcome is known: verified, checked or open (in scan.h5 0, 1, 2)"})};
    }
};

inline constexpr int told_turns = 8; ///< rods whose turns are columns

/// Columns of more than two rods: with two everybody knows which met.
struct MetPair {
    double i, j;

    static constexpr auto fields() {
        using R = MetPair;
        return std::tuple{
            field("pair_i", &R::i,
                  {"1", "of three or more rods: the first, from 0, of the captured pair; empty: "
                        "there is none"}),
            field("pair_j", &R::j, {"1", "the second of that pair"})};
    }
};

/// The last columns of rods with [noise].
struct CaptureNumbers {
    double probability, low, high, runs;

    static constexpr auto fields() {
        using R = CaptureNumbers;
        return std::tuple{
            field("capture_probability", &R::probability,
                  {"1", "share of the runs with noise that end in capture"}),
            field("capture_probability_low", &R::low,
                  {"1", "lower end of its 95 % interval (Wilson); itself without noise"}),
            field("capture_probability_high", &R::high,
                  {"1", "upper end of its 95 % interval (Wilson); itself without noise"}),
            field("capture_runs", &R::runs, {"1", "runs with noise behind it; 1 without noise"})};
    }
};

EncounterEnd end_of(const rods::RodProblem& problem, const rods::RodResult& run,
                    const RelativeDisplacement& ahead);
EncounterEnd end_of(const rods::PairProblem& pair, const rods::PairResult& run);

/// Into the columns of the plan, in output units; a number that is not finite makes the point fail.
void store(const EncounterEnd& end, const ScanPlan& plan, const OutputUnits& units, scan::Result& result);

/// Columns of scan.csv and scan_runs.csv beside the axes, which have the names of their keys. "{scan length}"
/// and "{scan time}" stand for a and s of beds, else for the units of the run's theory.
std::span<const ColumnInfo> scan_columns();

} // namespace rodwake::app
