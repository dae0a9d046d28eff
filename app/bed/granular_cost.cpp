#include "granular_cost.hpp"

#include "granular_run.hpp"
#include "rodwake/app/describe.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/granular/start.hpp"
#include "run/cost_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::app {

namespace {

using granular::StepTimes;

constexpr std::int64_t timed_every = 17;

/// Parts of the steps here and there.
constexpr std::pair<double RunCost::*, double StepTimes::*> step_parts[] = {
    {&RunCost::flight, &StepTimes::flight},
    {&RunCost::rods, &StepTimes::rods},
    {&RunCost::search, &StepTimes::search},
    {&RunCost::impulses, &StepTimes::impulses}};

} // namespace

const std::array<CostPart, 9> cost_parts = {{{"start", "start", &RunCost::start},
                                             {"flight", "flight, bounces off the plates", &RunCost::flight},
                                             {"rods", "motion of the rods", &RunCost::rods},
                                             {"search", "search for contacts", &RunCost::search},
                                             {"impulses", "impulses between pairs", &RunCost::impulses},
                                             {"records", "samples, rows of the table", &RunCost::records},
                                             {"measures", "measures", &RunCost::measures},
                                             {"output", "frames, checkpoints, files", &RunCost::output},
                                             {"other", "other", &RunCost::other}}};

double RunCost::of_steps_and_records() const {
    double sum = -start;
    for (const CostPart& part : cost_parts)
        sum += this->*part.seconds;
    return sum;
}

double RunCost::particle_steps_per_second() const {
    const double seconds = of_steps_and_records();
    return seconds > 0.0 ? particle_steps / seconds : 0.0;
}

RunCost& RunCost::operator+=(const RunCost& more) {
    for (const CostPart& part : cost_parts)
        this->*part.seconds += more.*part.seconds;
    particle_steps += more.particle_steps;
    return *this;
}

double CostMeter::lap() {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - before_).count();
    before_ = now;
    return seconds;
}

void CostMeter::advance(granular::Simulation& simulation, std::int64_t steps) {
    mark(&RunCost::other);
    const std::int64_t begin = simulation.step(), end = begin + steps;
    if (steps_ == 0 && steps > 0) {
        first_ = simulation.advance_timed(1);
        lap();
    }
    while (simulation.step() < end && !simulation.failure()) {
        const std::int64_t past = simulation.step() % timed_every;
        if (past == 0)
            sampled_ += simulation.advance_timed(1);
        else
            simulation.advance(std::min(end - simulation.step(), timed_every - past));
    }
    steps_ += simulation.step() - begin;
    stepping_ += lap();
}

RunCost CostMeter::cost() const {
    RunCost all = marked_;
    const StepTimes& shares = sampled_.steps > 0 ? sampled_ : first_;
    double sum = 0.0;
    for (const auto& [mine, theirs] : step_parts)
        sum += shares.*theirs;
    for (const auto& [mine, theirs] : step_parts)
        all.*mine += first_.*theirs + (sum > 0.0 ? stepping_ * shares.*theirs / sum : 0.0);
    all.particle_steps = sphere_steps(problem_) * static_cast<double>(steps_) /
                         static_cast<double>(problem_.equilibration_steps + problem_.steps);
    return all;
}

std::vector<std::string> cost_lines(const RunCost& cost, std::size_t runs) {
    const double all = cost.start + cost.of_steps_and_records();
    std::vector<std::string> lines = {
        fmt::format("{} of wall clock{}, {:.3g} particle steps a second without the start; of these (steps: "
                    "every {}th timed)",
                    duration_text(all), runs > 1 ? fmt::format(" summed over {} runs", runs) : "",
                    cost.particle_steps_per_second(), timed_every)};
    for (const CostPart& part : cost_parts)
        if (const double seconds = cost.*part.seconds; seconds > 0.0)
            lines.push_back(fmt::format("  {:<30} {:>8} {:>8}", part.words, duration_text(seconds),
                                        fmt::format("{:.1f} %", 100.0 * seconds / all)));
    return lines;
}

namespace {

using granular::GranularProblem;

/// CPU seconds of a run: its steps times that of one in a bed that was shaken for a moment; a lattice stands
/// for every start. Measures and output come on top. Throws RunError for a bed that fails so soon.
double seconds_of_run(const BedPlan& bed) {
    GranularProblem problem = bed.problem;
    problem.start =
        granular::bead_mix(problem).one_size() ? granular::Start::lattice : granular::Start::random;
    problem.given.reset();
    if (problem.start == granular::Start::random) // jammed at first; the run takes it apart before t = 0
        problem.overlap_limit = 1.0;
    problem.equilibration_steps = 0;
    problem.steps = 1'000'000'000'000;
    granular::Simulation simulation(problem, granular::make_start(problem, 0));
    double each = 0.0;
    for (const double budget : {0.6 * cost_budget, 0.4 * cost_budget}) { // shaken, then timed
        constexpr std::int64_t chunk = 20;
        std::int64_t steps = 0;
        const Stopwatch watch;
        do {
            simulation.advance(chunk);
            steps += chunk;
        } while (watch.seconds() < budget && !simulation.failure());
        if (simulation.failure())
            throw RunError("the bed stops soon (" + simulation.failure()->message + ")");
        each = watch.seconds() / static_cast<double>(steps);
    }
    return each * static_cast<double>(bed.problem.steps + bed.problem.equilibration_steps);
}

std::string output_text(const BedPlan& bed) {
    const std::string advice = output_advice(bed);
    return fmt::format("  output of a run: {}\n{}", describe_output(bed),
                       advice.empty() ? "" : fmt::format("  large: {}\n", advice));
}

} // namespace

std::string bed_cost(const Plan& plan) {
    const BedPlan& first = plan.beds.front();
    const double one = seconds_of_run(first);
    const auto runs = static_cast<double>(first.of.scene.granular->runs);
    std::string text = fmt::format("  granular run: about {:.2g} CPU seconds", one);
    if (runs > 1.0)
        text += fmt::format(" each, {:.2g} for {:g} runs", one * runs, runs);
    if (plan.beds.size() > 1) {
        double all = 0.0;
        for (const BedPlan& bed : plan.beds)
            all += one * sphere_steps(bed.problem) / sphere_steps(first.problem) *
                   static_cast<double>(bed.of.scene.granular->runs);
        text += fmt::format("; {:.2g} for all {} beds", all, plan.beds.size());
    }
    return text + (first.measures ? "; measures come on top\n" : "\n") + output_text(first);
}

/// Of all runs, as dear as they are compared with the bed as written.
std::string bed_scan_cost(const Plan& plan) {
    const BedPlan& first = plan.beds.front();
    const double one = seconds_of_run(first);
    const scan::Design& design = plan.scan->design;
    double all = 0.0;
    for (const double cost : design.costs)
        all += one * cost / sphere_steps(first.problem) * static_cast<double>(design.runs);
    return fmt::format(
               "  scan: {} runs, about {:.2g} CPU seconds each (the bed as written), {:.2g} in all ({:.2g} "
               "hours){}\n",
               scan::size(design), one, all, all / 3600.0,
               first.schedule.stop_at_travel > 0.0 ? "; less, as far as runs end at stop_at_travel" : "") +
           output_text(first);
}

} // namespace rodwake::app
