#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/core/box_sides.hpp"

#include "outcome_text.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/wake_bound.hpp"
#include "rodwake/rods/settled_orbit.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::rods {

namespace {

using integrate::State;

/// Ending of all pairs together; sets the pair it is about.
void classify(RodOutcome& outcome, bool interacting, const RodProblem& problem, const StateRates& rates,
              State y, const SeparationRecord& record, const EndingCriteria& criteria) {
    const Box box = problem.box;
    const std::size_t rods = y.size() / 3;
    std::vector<double> ydot(y.size());
    rates(y, ydot);
    // How far rods feel each other is known of the theory's own field on the plane only.
    const bool unknown_reach = !problem.medium || problem.field || box;
    const auto feel = [&](double distance) {
        return interacting && (unknown_reach || reaches(*problem.medium, problem.couplings, distance,
                                                        problem.t_end, criteria.felt_turn));
    };
    bool all_escape = true;
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b) {
            const Ending ending = classify_pair(y, ydot, a, b, record.late[a * rods + b], criteria, box);
            all_escape = all_escape && ending == Ending::escape;
            const Offset d = offset(y, a, b, box);
            const double distance = std::hypot(d.x, d.y);
            if (ending == Ending::pursuit && outcome.ending != Ending::pursuit && feel(distance)) {
                outcome.ending = Ending::pursuit;
                outcome.pair = {a, b, distance};
                outcome.separation = distance;
            }
            if (ending != Ending::escape && outcome.failed.empty())
                outcome.failed = failed_criteria(y, ydot, a, b, record.late[a * rods + b], criteria, box);
        }
    if (all_escape)
        outcome.ending = Ending::escape;
    if (outcome.ending != Ending::undecided)
        outcome.failed.clear();
}

/// Two rods in each other's steady wakes on the plane: whether they have settled in an orbit, and of a
/// pursuit whether it lasts.
void look_at_pair(RodOutcome& outcome, const RodProblem& problem, const StateRates& rates, State y) {
    if (y.size() != 6 || !problem.medium || problem.field || problem.box || problem.rows.any())
        return;
    if (outcome.ending == Ending::undecided) {
        // Nearer than this bodies could touch, and then the flow is another.
        std::optional<double> nearest_without_touch = problem.contact_distance;
        if (problem.bodies.any())
            nearest_without_touch = std::max(problem.contact_distance.value_or(0.0),
                                             BodyForces(problem.bodies, 2, problem.box).farthest_touch());
        std::string failed;
        const auto settled = settled_orbit(*problem.medium, problem.couplings, pose(y, 0), pose(y, 1),
                                           nearest_without_touch, &failed);
        if (!settled) {
            outcome.failed += fmt::format(", no orbit ({})", failed);
        } else {
            outcome.failed.clear();
            outcome.ending = Ending::orbit;
            outcome.separation = settled->orbit.separation[0];
            outcome.omega = settled->orbit.omega;
            outcome.pair = {0, 1, outcome.separation};
        }
    } else if (outcome.ending == Ending::pursuit) {
        std::vector<double> ydot(y.size());
        rates(y, ydot);
        const Offset d = offset(y, 0, 1, {});
        outcome.grows = d.x * (ydot[0] - ydot[3]) + d.y * (ydot[1] - ydot[4]) > 0.0;
        outcome.stable =
            in_line_eigenvalues(*problem.medium, problem.couplings, outcome.separation)[0].real() < 0.0;
    }
}

/// All but the separation at the start.
void validate_shape(const RodProblem& problem) {
    if (problem.rods.empty())
        throw InputError("no rods: give at least one");
    if (!(problem.t_end > 0.0 && std::isfinite(problem.t_end)))
        throw InputError(fmt::format("t_end = {}: must be > 0 and finite", problem.t_end));
    if (problem.box && !valid_sides(*problem.box))
        throw InputError(fmt::format("box = {}: the sides of the periodic box must be > 0 and finite",
                                     to_string(*problem.box)));
    if (problem.contact_distance && !(*problem.contact_distance > 0.0))
        throw InputError(fmt::format("contact_distance = {}: must be > 0", *problem.contact_distance));
    for (const double number : to_state(problem.rods))
        if (!std::isfinite(number))
            throw InputError(fmt::format("rods: {}: places and headings must be finite", number));
    double before = 0.0;
    for (const double time : problem.output_times) {
        if (!(time >= before && time <= problem.t_end * (1.0 + 1e-12)))
            throw InputError(
                fmt::format("output_times: {}: must rise within 0 and t_end = {}", time, problem.t_end));
        before = time;
    }
}

} // namespace

std::optional<RodResult> contact_at_start(const RodProblem& problem) {
    if (!problem.contact_distance || problem.rods.size() < 2)
        return std::nullopt;
    RodResult result;
    integrate::Solution& solution = result.solution;
    solution.final_state = to_state(problem.rods);
    if (!(closest_pair(solution.final_state, problem.box).distance <= *problem.contact_distance))
        return std::nullopt;
    validate_shape(problem);
    for (const double time : problem.output_times)
        if (time == 0.0) {
            solution.times.push_back(0.0);
            solution.states.push_back(solution.final_state);
        }
    solution.hits.push_back({0, 0.0, solution.final_state});
    solution.status.termination = integrate::Termination::stopped_at_event;
    solution.status.wanted = problem.t_end;
    result.outcome = classify_outcome(problem, false, nullptr, solution, {}, {});
    return result;
}

void validate(const RodProblem& problem) {
    validate_shape(problem);
    if (problem.rods.size() < 2)
        return;
    const Separation pair = closest_pair(to_state(problem.rods), problem.box);
    if (!(pair.distance > 0.0))
        throw InputError(
            fmt::format("rods[{}] and rods[{}] are in the same place: their fields are singular there",
                        pair.first, pair.second));
    if (problem.contact_distance && !(*problem.contact_distance < pair.distance))
        throw InputError(
            fmt::format("contact_distance = {}: must be below the smallest starting separation, {} "
                        "between rods[{}] and rods[{}]",
                        *problem.contact_distance, pair.distance, pair.first, pair.second));
    if (const BodyForces bodies(problem.bodies, problem.rods.size(), problem.box);
        bodies.any() && !problem.goes_on) {
        constexpr double rounding = 1e-9; // of bodies that are to start in touch, f/mu
        const BodyContact near = bodies.closest(to_state(problem.rods));
        if (near.gap < -rounding)
            throw InputError(
                fmt::format("the bodies of rods[{}] and rods[{}] overlap by {:.4g} at the start: "
                            "start them farther apart",
                            near.first, near.second, -near.gap));
    }
}

bool reaches(const elastic::Medium& medium, const Couplings& c, double distance, double time, double angle) {
    const auto& [kappa, gamma1, gamma2] = c;
    const elastic::WakeBound bound(medium);
    double rate = 0.0;
    if (c.apolar())
        rate += std::abs(kappa) * bound.strain(distance, 0.0);
    if (c.polar())
        rate += (std::abs(gamma1) + std::abs(gamma2)) * bound.polar(distance, 0.0);
    return rate * time > angle;
}

std::vector<double> output_times(const RodProblem& problem) {
    std::vector<double> times = problem.output_times;
    if (times.empty() || times.back() < problem.t_end)
        times.push_back(problem.t_end);
    return times;
}

RodOutcome classify_outcome(const RodProblem& problem, bool interacting, const StateRates& rates,
                            const integrate::Solution& solution, const SeparationRecord& record,
                            const EndingCriteria& criteria, TurnedBy turned_by) {
    const State y = solution.final_state;
    const std::size_t rods = problem.rods.size();
    RodOutcome outcome;
    outcome.time = solution.final_time;
    for (std::size_t a = 0; a < rods; ++a)
        outcome.turn.push_back(y[3 * a + 2] - problem.rods[a].heading);
    const bool contact = solution.status.termination == integrate::Termination::stopped_at_event;
    if (rods > 1) {
        outcome.pair = contact ? closest_pair(y, problem.box) : record.smallest;
    }
    outcome.min_separation = contact ? outcome.pair.distance : record.smallest.distance;
    outcome.min_separation_time = contact ? outcome.time : record.smallest_time;
    if (problem.bodies.any() && rods > 1) {
        outcome.min_gap = record.bodies.smallest_gap;
        outcome.min_gap_time = record.bodies.smallest_gap_time;
    }
    const bool at_end = solution.status.termination == integrate::Termination::reached_end;
    const auto bound = at_end ? bound_pair(record, y, problem.t_end, problem.box) : std::nullopt;
    if (contact)
        outcome.ending = Ending::contact;
    else if (bound) {
        outcome.ending = Ending::bound;
        outcome.pair = *bound;
        outcome.separation = bound->distance;
    } else if (at_end && !record.late.empty())
        classify(outcome, interacting, problem, rates, y, record, criteria);
    if (interacting && turned_by == TurnedBy::steady_wakes && at_end && !record.late.empty())
        look_at_pair(outcome, problem, rates, y);
    describe(outcome, rods, solution.status);
    return outcome;
}

void explain_collision(integrate::Solution& solution, Box box) {
    constexpr double near = 0.05; // f/mu
    if (solution.status.ok() || solution.final_state.size() < 6)
        return;
    const Separation pair = closest_pair(solution.final_state, box);
    if (pair.distance > near)
        return;
    solution.status.cause =
        fmt::format("rods[{}] and rods[{}] are {:.3g} apart, and their fields are singular at contact",
                    pair.first, pair.second, pair.distance);
    solution.status.advice = "set rods_run.contact_distance, so that the run stops when two rods meet";
}

} // namespace rodwake::rods
