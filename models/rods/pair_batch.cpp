#include "rodwake/rods/pair_batch.hpp"

#include "outcome_text.hpp"
#include "pair_lanes.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/settled_orbit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rodwake::rods {

namespace {

void require(bool legal, const char* name, double value, const char* range) {
    if (!legal)
        throw InputError(fmt::format("{} = {}: must be {}", name, value, range));
}

double start_separation(const PairProblem& pair) {
    return std::hypot(pair.rods[0].x - pair.rods[1].x, pair.rods[0].y - pair.rods[1].y);
}

bool starts_in_contact(const PairProblem& pair) {
    return pair.contact_distance > 0.0 && start_separation(pair) <= pair.contact_distance;
}

} // namespace

std::optional<PairProblem> to_pair_problem(const RodProblem& problem) {
    if (problem.rods.size() != 2 || problem.box || problem.field || !problem.medium ||
        !problem.couplings.any() || problem.rows.any() || problem.bodies.any() ||
        !has_wide_wakes(*problem.medium))
        return std::nullopt;
    return PairProblem{*problem.medium,
                       problem.couplings,
                       {problem.rods[0], problem.rods[1]},
                       problem.t_end,
                       problem.contact_distance.value_or(0.0)};
}

RodProblem to_rod_problem(const PairProblem& pair) {
    RodProblem problem{pair.medium, pair.couplings, {pair.rods[0], pair.rods[1]}, pair.t_end, {}, {}};
    if (pair.contact_distance != 0.0)
        problem.contact_distance = pair.contact_distance;
    return problem;
}

void validate(const PairProblem& pair) {
    const double r = start_separation(pair);
    const double headings = std::abs(pair.rods[0].heading) + std::abs(pair.rods[1].heading);
    elastic::validate(pair.medium);
    if (!(pair.t_end > 0.0 && std::isfinite(pair.t_end) && (r > 0.0 || starts_in_contact(pair))))
        validate(to_rod_problem(pair)); // says what is wrong
    require(std::isfinite(r) && std::isfinite(headings), "a coordinate of the pair", r + headings, "finite");
    require(pair.contact_distance >= 0.0, "contact_distance", pair.contact_distance, ">= 0");
}

void simulate_pairs(std::span<const PairProblem> pairs, const PairOptions& options,
                    std::span<PairResult> results) {
    require(options.rtol >= 1e-13 && options.rtol <= 0.1, "rtol", options.rtol, "in [1e-13, 0.1]");
    require(options.atol > 0.0 && std::isfinite(options.atol), "atol", options.atol, "> 0 and finite");
    if (pairs.size() != results.size())
        throw InputError(fmt::format("{} results for {} pairs: give as many", results.size(), pairs.size()));
    std::vector<std::size_t>
        order[2]; // without and with polar couplings: a lane computes no more than its pair needs
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        validate(pairs[i]);
        if (!starts_in_contact(pairs[i])) {
            order[pairs[i].couplings.polar()].push_back(i);
            continue;
        }
        PairResult& result = results[i] = {};
        result.ending = Ending::contact;
        std::ranges::copy(to_state(pairs[i].rods), result.state.begin());
        result.rate.fill(std::nan(""));
        result.separation = result.min_separation = start_separation(pairs[i]);
    }
    for (const bool polar : {false, true}) {
        if (order[polar].empty())
            continue;
        std::size_t next = 0;
        PairQueue first(pairs, order[polar], next, options, results),
            second(pairs, order[polar], next, options, results);
        first.fill(pair_lane_count());
        second.fill(pair_lane_count());
        run_pairs(first, second, polar);
    }
}

RodOutcome outcome_of(const PairProblem& pair, const PairResult& result, const EndingCriteria& criteria) {
    RodOutcome outcome;
    outcome.ending = result.ending;
    outcome.time = result.time;
    const bool at_end = result.ending == Ending::contact || result.ending == Ending::pursuit;
    outcome.pair = {0, 1, at_end ? result.separation : result.min_separation};
    if (result.ending == Ending::pursuit)
        outcome.separation = result.separation;
    if (result.ending == Ending::orbit) {
        outcome.separation = outcome.pair.distance = result.orbit_separation;
        outcome.omega = result.omega;
    }
    outcome.min_separation = result.min_separation;
    outcome.min_separation_time = result.min_separation_time;
    outcome.turn = {result.turn[0], result.turn[1]};
    if (result.ending == Ending::undecided && !result.handed_over()) {
        std::string orbit;
        const auto& y = result.state;
        const std::optional<double> contact =
            pair.contact_distance > 0.0 ? std::optional(pair.contact_distance) : std::nullopt;
        settled_orbit(pair.medium, pair.couplings, {y[0], y[1], y[2]}, {y[3], y[4], y[5]}, contact, &orbit);
        outcome.failed = fmt::format("{}, no orbit ({})",
                                     failed_criteria(y, result.rate, 0, 1, result.late, criteria), orbit);
    }
    integrate::Status status;
    if (result.handed_over())
        status.termination = integrate::Termination::failed;
    describe(outcome, 2, status);
    return outcome;
}

} // namespace rodwake::rods
