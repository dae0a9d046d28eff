#include "granular_cost.hpp"

#include "rodwake/app/granular.hpp"
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

} // namespace rodwake::app
