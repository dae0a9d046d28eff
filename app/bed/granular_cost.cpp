#include "granular_cost.hpp"

#include "granular_run.hpp"
#include "measure_frames.hpp"
#include "rodwake/app/describe.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/app/measure_kind.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/granular/record.hpp"
#include "rodwake/granular/start.hpp"
#include "run/cost_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

double whole(const StepTimes& times) {
    double sum = 0.0;
    for (const auto& [mine, theirs] : step_parts)
        sum += times.*theirs;
    return sum;
}

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
    const double sum = whole(shares);
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
                                        percent_text(seconds / all)));
    return lines;
}

// What a granular bed costs: the parts of a step, what is recorded, and what is measured.

namespace {
using granular::GranularProblem;
using granular::Simulation;

constexpr double to_shake = 0.3 * cost_budget, of_steps = 0.2 * cost_budget, of_a_record = 0.03 * cost_budget;

/// CPU seconds of a step, from as many as there is time for; 0: the bed fails.
double seconds_of_step(Simulation& simulation, double budget) {
    constexpr std::int64_t chunk = 10;
    std::int64_t steps = 0;
    const Stopwatch watch;
    do {
        simulation.advance(chunk);
        steps += chunk;
    } while (watch.seconds() < budget && !simulation.failure());
    return simulation.failure() ? 0.0 : watch.seconds() / static_cast<double>(steps);
}

/// Without an end, and rods free from the first step on. A lattice stands for every start.
GranularProblem endless(GranularProblem problem) {
    problem.start = granular::Start::lattice;
    problem.equilibration_steps = 0;
    problem.steps = 1'000'000'000'000;
    return problem;
}

Simulation shaken(const GranularProblem& problem) {
    Simulation simulation(problem, granular::make_start(problem, 0));
    seconds_of_step(simulation, to_shake);
    return simulation;
}

double longest_step(const GranularProblem& problem) {
    return problem.plates.longest_step(problem.gravity, problem.bead_radius);
}

/// A step of another bed that starts from this state; nothing if there is no such bed.
std::optional<double> seconds_of_other(const GranularProblem& problem, const granular::State& state) {
    try {
        Simulation simulation(problem, state);
        seconds_of_step(simulation, 0.2 * of_steps); // its lists are made
        const double step = seconds_of_step(simulation, 0.8 * of_steps);
        return step > 0.0 ? std::optional(step) : std::nullopt;
    } catch (const InputError&) {
        return std::nullopt;
    }
}

std::optional<double> seconds_without_rods(const Simulation& simulation) {
    GranularProblem problem = simulation.problem();
    granular::State state = simulation.state();
    problem.rods.clear();
    state.rods.clear();
    return problem.beads > 0 ? seconds_of_other(problem, state) : std::nullopt;
}

/// Of the longest step that follows the bed. Nothing if the bed's own is as long.
std::optional<double> seconds_of_longest_step(const Simulation& simulation) {
    GranularProblem problem = simulation.problem();
    granular::State state = simulation.state();
    const double ratio = longest_step(problem) / problem.time_step;
    if (ratio < 1.001)
        return {};
    problem.time_step *= ratio;
    state.step = std::llround(static_cast<double>(state.step) / ratio); // the phase of the plates
    return seconds_of_other(problem, state);
}

/// Where a run's time goes. Seconds a step.
struct BedTimes {
    std::string failure;
    double step = 0.0; ///< without what is recorded and measured
    granular::StepTimes parts;
    double records = 0.0, measures = 0.0;
    std::vector<CostRow> measure_rows; ///< shares and savings still in seconds a step

    double all() const { return step + records + measures; }
};

/// Samples and rows of the table, a step.
double seconds_of_records(const BedPlan& bed, const Simulation& simulation) {
    granular::Record record(bed.schedule.order_cutoff, bed.problem.rods.size());
    const double sample = seconds_of([&] { record.sample(simulation); }, of_a_record),
                 row = seconds_of([&] { record.row(simulation), record.track(simulation); }, of_a_record);
    return sample / static_cast<double>(sample_every) + row / static_cast<double>(bed.schedule.row_every);
}

/// Of all steps the share that lies between frames to be measured.
double measured_share(const BedPlan& bed) {
    const double steps = static_cast<double>(bed.problem.steps + bed.problem.equilibration_steps),
                 from = bed.measures->sums.from() / bed.problem.time_step;
    return std::max(0.0, static_cast<double>(bed.problem.steps) - from) / steps;
}

/// Each measure by itself, on frames of the shaken bed.
void time_measures(const BedPlan& bed, const Simulation& simulation, BedTimes& times) {
    if (!bed.measures)
        return;
    measure::Measures sums = bed.measures->sums;
    measure::Frame frame;
    const auto fill = [&] { fill_frame(frame, simulation.state(), 0.0, bed.problem.box); };
    const double per_step = measured_share(bed) / static_cast<double>(bed.measures->every);
    const auto add = [&](std::string term, double each, double stride, bool saves) {
        const double share = per_step * each / stride;
        times.measures += share;
        times.measure_rows.push_back({std::move(term), duration_text(each) + " a frame", share,
                                      saves ? std::optional(share) : std::nullopt});
    };
    add("frames for the measures", seconds_of(fill, of_a_record), 1.0, false);
    frame.time = sums.from();
    for (const MeasureKind& kind : measure_kinds())
        if (measure::Accumulator* one = sums.find(kind.name)) {
            const auto stride = static_cast<double>(sums.stride(kind.name));
            const auto measure = [&] {
                frame.time += stride * bed.measures->interval;
                one->add(frame);
            };
            add(fmt::format("measure.{}", kind.name), seconds_of(measure, of_a_record), stride, true);
        }
}

BedTimes times_of(const BedPlan& bed, Simulation& simulation) {
    BedTimes times;
    times.step = seconds_of_step(simulation, of_steps);
    const Stopwatch watch;
    while (watch.seconds() < of_steps && !simulation.failure())
        times.parts += simulation.advance_timed(10);
    if (simulation.failure())
        times.failure = simulation.failure()->message;
    else {
        times.records = seconds_of_records(bed, simulation);
        time_measures(bed, simulation, times);
    }
    return times;
}

std::vector<CostRow> rows_of(const BedPlan& bed, const Simulation& simulation, const BedTimes& times) {
    std::vector<CostRow> rows;
    const granular::StepTimes& p = times.parts;
    const double whole = p.flight + p.rods + p.search + p.impulses, all = times.all();
    const auto add = [&](const char* term, double seconds, std::optional<double> without) {
        const double each = times.step * seconds / whole;
        rows.push_back({term, duration_text(each) + " a step", each / all,
                        without ? std::optional((times.step - *without) / all) : std::nullopt});
    };
    add("flight, bounces off the plates", p.flight, {});
    if (!bed.problem.rods.empty())
        add("motion of the rods", p.rods, seconds_without_rods(simulation));
    add("search for contacts", p.search, {});
    add("impulses between pairs", p.impulses, {});
    rows.push_back(
        {"samples, rows of the table", duration_text(times.records) + " a step", times.records / all, {}});
    for (CostRow row : times.measure_rows) {
        *row.share /= all;
        if (row.saved)
            *row.saved /= all;
        rows.push_back(std::move(row));
    }
    if (const auto longer = seconds_of_longest_step(simulation)) {
        const double longest = longest_step(bed.problem);
        rows.push_back({fmt::format("granular.time_step = {:g}", longest),
                        duration_text(*longer) + " a step",
                        {},
                        (times.step - *longer * bed.problem.time_step / longest) / all});
    }
    return rows;
}

double steps_of(const BedPlan& bed) {
    return static_cast<double>(bed.problem.steps + bed.problem.equilibration_steps);
}

std::string failed_text(const std::string& failure) {
    return fmt::format("  granular run: stops soon ({})\n", failure);
}

std::string output_text(const BedPlan& bed) {
    const std::string advice = output_advice(bed);
    return fmt::format("  output of a run: {}\n{}", describe_output(bed),
                       advice.empty() ? "" : fmt::format("  large: {}\n", advice));
}

} // namespace

std::string bed_cost(const Plan& plan) {
    const BedPlan& first = plan.beds.front();
    Simulation simulation = shaken(endless(first.problem));
    const BedTimes times = times_of(first, simulation);
    if (!times.failure.empty())
        return failed_text(times.failure);
    const double one = times.all() * steps_of(first);
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
    return text + "\n" + cost_table(rows_of(first, simulation, times)) + output_text(first);
}

/// Of all runs, as dear as they are compared with the bed as written.
std::string bed_scan_cost(const Plan& plan) {
    BedPlan first = plan.beds.front();
    first.measures.reset(); // a scan follows the rods alone
    Simulation simulation = shaken(endless(first.problem));
    const BedTimes times = times_of(first, simulation);
    if (!times.failure.empty())
        return failed_text(times.failure);
    const scan::Design& design = plan.scan->design;
    const double one = times.all() * steps_of(first);
    double all = 0.0;
    for (const double cost : design.costs)
        all += one * cost / sphere_steps(first.problem) * static_cast<double>(design.runs);
    return fmt::format(
               "  scan: {} runs, about {:.2g} CPU seconds each (the bed as written), {:.2g} in all ({:.2g} "
               "hours){}\n",
               scan::size(design), one, all, all / 3600.0,
               first.schedule.stop_at_travel > 0.0 ? "; less, as far as runs end at stop_at_travel" : "") +
           cost_table(rows_of(first, simulation, times)) + output_text(first);
}

} // namespace rodwake::app
