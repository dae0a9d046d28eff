#pragma once
// Many independent pairs of rods at once, a pair a lane: for scans, whose points differ in couplings, medium
// and start.
//
// Method: Tsitouras-Famelis 6(5) (integrate/tsitouras_famelis.hpp), each lane with its own step, error, step
// limit (encounter_step) and end; a lane whose pair has ended takes the next one. Contact is located by
// shortening the step that passes it until its end lies on it. Tolerances, endings and the record of
// separations are those of rods::simulate, which remains the reference.
//
// Bits: a pair's result depends on this pair and the options, on nothing else: not on the other pairs, the
// lanes of a vector or the instruction set.
//
// Explicit: a pair whose headings relax much faster than the rods walk would take tens of thousands of steps.
// Such a pair, and one that leaves the range of the kernels (elastic/wake_kernel.hpp), is handed over: run it
// through rods::simulate.
//
// Error of state and time, 20000 random pairs (median, 90 %, 99 %): at rtol 1e-6 4e-7, 4e-6, 5e-5; at 1e-9
// 3e-10, 2e-9, 2e-8; all end as with CVODES (studies/reports/rods.md; build/dev/tests/test_rods).
//
// Degenerate input:
//   no pairs                                                 nothing is done
//   coincident rods                                          InputError; contact at 0 with a contact distance
//   a place, heading, distance or tolerance that is NaN      InputError, before any pair is run
//   eta < 0, xi = 1e-30 or 1e30, a coupling that is NaN      handed over at t = 0, out_of_range
//   rods that pass through each other                        handed over, out_of_range
//   no coupling                                              straight walks

#include "rodwake/rods/simulate.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

namespace rodwake::rods {

/// Reduced units, infinite plane.
struct PairProblem {
    elastic::Medium medium; ///< eta < 0 is handed over
    Couplings couplings;
    std::array<Pose, 2> rods;
    double t_end = 0.0;
    double contact_distance = 0.0; ///< stop when the rods are this close, also at the start; 0: never
};

/// The problem as a pair for the batch; nothing if it is none: not two rods, a periodic box, a field of
/// its own, no medium or no coupling, wakes so narrow that steps are limited by wake_step.
std::optional<PairProblem> to_pair_problem(const RodProblem& problem);
RodProblem to_rod_problem(const PairProblem& pair);

/// Where a pair is at the end of a step.
struct PairStep {
    double time = 0.0;
    std::array<double, 6> state{}, rate{}; ///< as in model.hpp, and its time derivative
};

struct PairOptions {
    double rtol = 1e-8, atol = 1e-10; ///< as OdeOptions: atol counts up to rtol/10
    EndingCriteria criteria = {};
    /// Steps, rejected ones included, before a pair is handed over. At rtol 1e-6 the longest of 400 pairs
    /// takes 160 at kappa = 100 and 3700 at 1e4; from about 10000 on BDF is faster.
    long max_attempts = 10'000;
    /// Called after each step of a pair, with its number, in the order of its times; the bits do not depend
    /// on it.
    std::function<void(std::size_t pair, const PairStep& step)> on_step = nullptr;
};

enum class PairEnding {
    finished,
    too_many_steps, ///< handed over: stiff, or endless turning
    out_of_range ///< handed over: beyond the kernels, the steps became too small to add to the time, or the
                 ///< rods passed through each other (passing_resolution)
};

struct PairResult {
    PairEnding end = PairEnding::finished;
    Ending ending = Ending::undecided;
    double time = 0.0;                          ///< of contact, else the time reached
    std::array<double, 6> state{}, rate{};      ///< at that time, as in model.hpp, and its time derivative
                                                ///< (NaN where the rods start in contact)
    double separation = 0.0;                    ///< at that time
    double orbit_separation = NAN, omega = NAN; ///< of an orbit, as in RodOutcome
    double min_separation = 0.0;                ///< at any time
    double min_separation_time = 0.0;           ///< when
    std::array<double, 2> turn{};               ///< theta(end) - theta(0), rad
    double ahead_x = 0.0,
           ahead_y = 0.0; ///< R_0 - R_1 less its start, at the step end when the rods had turned most
    TailWindow late{};    ///< of a pair that has run to t_end
    Certificate certificate = Certificate::open; ///< by simulate_certified (certificate.hpp)
    long steps = 0, rhs_evaluations = 0;

    bool handed_over() const { return end != PairEnding::finished; }
};

/// Runs each pair to its t_end or to contact; results[i] is that of pairs[i]. Throws InputError as
/// rods::simulate does for one of them, before any is run, and for spans of unlike lengths or illegal
/// tolerances. Thread-safe.
void simulate_pairs(std::span<const PairProblem> pairs, const PairOptions& options,
                    std::span<PairResult> results);

/// Throws InputError if simulate_pairs would for this pair.
void validate(const PairProblem& pair);

/// A finished pair as rods::simulate tells it, in words too.
RodOutcome outcome_of(const PairProblem& pair, const PairResult& result, const EndingCriteria& criteria = {});

} // namespace rodwake::rods
