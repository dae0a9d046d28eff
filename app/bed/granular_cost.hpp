#pragma once
// Where the time of granular runs went, part by part, in seconds of wall clock: what stands in summary.json
// and is written at the end. A run that was interrupted goes on counting where its checkpoint stopped.

#include "rodwake/granular/simulation.hpp"

#include <array>
#include <chrono>
#include <string>
#include <vector>

namespace rodwake::app {

struct RunCost {
    double start = 0.0; ///< beads and rods put into the box, files taken up
    double flight = 0.0, rods = 0.0, search = 0.0, impulses = 0.0; ///< parts of the steps, as StepTimes
    double records = 0.0;                                          ///< samples, rows of the table
    double measures = 0.0;
    double output = 0.0; ///< frames, checkpoints, final files
    double other = 0.0;
    double particle_steps = 0.0; ///< spheres of beads and rods, times steps

    /// Of everything but the start, s.
    double of_steps_and_records() const;
    double particle_steps_per_second() const;
    RunCost& operator+=(const RunCost& other);
};

/// A part of the cost: its name in summary.json, and in words those of `rodwake check`.
struct CostPart {
    const char *name, *words;
    double RunCost::*seconds;
};
extern const std::array<CostPart, 9> cost_parts;

/// Follows one run with a single clock, so that all time belongs to some part. The parts of a step are timed
/// on the first step, which makes the lists, and on every 17th (no divisor of a plate period, which is a
/// round number of steps); the others are divided as these are. To time every step would cost some per cent
/// where it takes a microsecond.
class CostMeter {
public:
    explicit CostMeter(const granular::GranularProblem& problem) : problem_(problem) {}

    /// The same steps to the bit as Simulation::advance.
    void advance(granular::Simulation& simulation, std::int64_t steps);
    /// What has passed since the last mark, or call of advance, belongs to this part.
    void mark(double RunCost::*part) { marked_.*part += lap(); }
    /// Up to the last mark.
    RunCost cost() const;

private:
    using Clock = std::chrono::steady_clock;
    double lap();

    const granular::GranularProblem& problem_;
    Clock::time_point before_ = Clock::now();
    RunCost marked_;
    granular::StepTimes first_, sampled_;
    double stepping_ = 0.0; ///< all steps but the first, s
    std::int64_t steps_ = 0;
};

/// A table for the end of a command, line by line; `cost` is the sum of so many runs, which may have run side
/// by side.
std::vector<std::string> cost_lines(const RunCost& cost, std::size_t runs);

} // namespace rodwake::app
