#include "critical_encounters.hpp"

#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/pair_batch.hpp"
#include "rodwake/rods/settled_orbit.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace rodwake::app {

Encounters::Encounters(const ScanPlan& plan, const scan::Point& point, const std::function<bool()>& stop)
    : plan_(plan), point_(point), stop_(stop), evaluate_(evaluate_rods(plan, stop)), problem_(plan),
      axis_(plan.design.axes.size() - 1), units_(output_units(plan.base)) {
    const auto& names = plan.columns.observables;
    const auto number = [&](std::string_view name) {
        return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    };
    time_ = number("time"), closest_ = number("min_separation"), apart_ = number("final_separation"),
    orbit_ = number("separation");
}

Bracket Encounters::both(double low, double high) {
    const std::array points = {point(low), point(high)};
    std::array<scan::Result, 2> results;
    const std::size_t number = low == high ? 1 : 2;
    evaluate_(std::span(points).first(number), std::span(results).first(number));
    std::array<Encounter, 2> all;
    for (std::size_t k = 0; k < number; ++k) {
        const scan::Result& result = results[k];
        if (!result.ok())
            throw PointFailed{result.status, std::string(result.cause_text())};
        ++count;
        Encounter& one = all[k];
        one = {points[k].at[axis_], static_cast<Ending>(result.outcome),
               critical_group(*plan_.critical, result.outcome)};
        one.time = result.values[time_] / units_.time;
        one.closest = result.values[closest_] / units_.length;
        one.parted = one.ending == Ending::undecided && result.values[apart_] / units_.length > one.time;
        if (one.ending == Ending::orbit) {
            one.orbit = result.values[orbit_] / units_.length;
            one.closest = std::min(one.closest, one.orbit);
        }
    }
    return {all[0], all[number - 1]};
}

double Encounters::closest_approach(const Encounter& one) {
    if (one.ending != Ending::contact)
        return one.closest;
    rods::RodProblem problem = problem_at(one.at);
    if (rods::contact_at_start(problem))
        return one.closest;
    const double contact = *problem.contact_distance;
    problem.contact_distance = 1e-3 * contact;
    problem.t_end += one.time;
    rods::RodOptions all = options(problem);
    const bool may_orbit = has_fixed_points(problem);
    std::optional<double> first;
    double least = one.closest;
    long steps = 0;
    all.ode.max_steps =
        std::min(all.ode.max_steps, 20'000L); // rods that circle into each other go on for ever
    all.ode.on_step = [&](const integrate::Step& step) {
        if (const auto approach = rods::closest_approach(step, problem.box, contact); approach && !first)
            first = approach->pair.distance;
        least = std::min(least, rods::closest_pair(step.state, problem.box).distance);
        ++steps; // an orbit is known before the rods have settled; asking takes as long as 500 steps
        if (may_orbit && !first && steps >= 256 && std::has_single_bit(static_cast<unsigned long>(steps)))
            if (const auto settled = rods::settled_orbit(
                    *problem.medium, problem.couplings, rods::pose(step.state, 0), rods::pose(step.state, 1)))
                first = settled->orbit.separation[0];
    };
    all.ode.stop_requested = [&] { return first.has_value() || (stop_ && stop_()); };
    const rods::RodResult run = this->run(problem, all);
    if (run.outcome.ending == Ending::orbit)
        return std::min(run.outcome.min_separation, run.outcome.separation);
    return first.value_or(least);
}

rods::RodOptions Encounters::options(const rods::RodProblem& problem) const {
    rods::RodOptions all = rod_options(problem_.run(), problem);
    all.ode.stop_requested = stop_;
    return all;
}

rods::RodResult Encounters::run(const rods::RodProblem& problem, const rods::RodOptions& options) {
    ++count;
    return run_rods(problem_.run(), problem, options, true);
}

scan::Point Encounters::point(double value) const {
    scan::Point one = point_;
    one.id = 0;
    one.at[axis_] = value;
    std::fill(one.at.begin() + static_cast<std::ptrdiff_t>(axis_) + 1, one.at.end(), 0.0);
    return one;
}

bool has_fixed_points(const rods::RodProblem& problem) {
    return problem.rods.size() == 2 && problem.medium && !problem.box && !problem.field &&
           rods::to_pair_problem(problem).has_value();
}

} // namespace rodwake::app
