#include "rodwake/rods/separation_record.hpp"

#include "outcome_text.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/separation.hpp"
#include "within_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

using integrate::State;

namespace {

PairEnd pair_end(State y, State ydot, std::size_t a, std::size_t b, const TailWindow& late, Box box) {
    const Offset d = offset(y, a, b, box);
    PairEnd pair;
    pair.x = d.x;
    pair.y = d.y;
    pair.vx = ydot[3 * a] - ydot[3 * b];
    pair.vy = ydot[3 * a + 1] - ydot[3 * b + 1];
    pair.heading[0] = y[3 * a + 2];
    pair.heading[1] = y[3 * b + 2];
    pair.angle = angle_between(pair.heading[0], pair.heading[1]);
    pair.late = late;
    pair.late.max_turning =
        std::max({std::abs(ydot[3 * a + 2]), std::abs(ydot[3 * b + 2]), late.max_turning});
    return pair;
}

} // namespace

Ending classify_pair(State y, State ydot, std::size_t a, std::size_t b, const TailWindow& late,
                     const EndingCriteria& criteria, Box box) {
    return classify(pair_end(y, ydot, a, b, late, box), criteria);
}

std::string failed_criteria(State y, State ydot, std::size_t a, std::size_t b, const TailWindow& late,
                            const EndingCriteria& criteria, Box box) {
    return fmt::format("rods {} and {} show {}", a, b,
                       failed_criteria(pair_end(y, ydot, a, b, late, box), criteria));
}

void describe(RodOutcome& outcome, std::size_t rods, const integrate::Status& status) {
    if (!status.ok())
        outcome.reason = "the integration stopped early";
    else if (status.termination == integrate::Termination::interrupted)
        outcome.reason = fmt::format("interrupted at t = {:.6g}", outcome.time);
    else if (rods < 2)
        outcome.reason = "a single rod has no partner";
    else if (rods > most_followed_rods && outcome.ending != Ending::contact)
        outcome.reason =
            fmt::format("outcomes of pairs are not distinguished for more than {} rods; rods {} and {} came "
                        "closest, {:.6g} apart",
                        most_followed_rods, outcome.pair.first, outcome.pair.second, outcome.min_separation);
    else if (outcome.ending == Ending::contact && outcome.time == 0.0)
        outcome.reason = fmt::format("rods {} and {} start {:.6g} apart, within the contact distance",
                                     outcome.pair.first, outcome.pair.second, outcome.pair.distance);
    else if (outcome.ending == Ending::contact)
        outcome.reason = fmt::format("rods {} and {} came within {:.6g} at t = {:.6g}", outcome.pair.first,
                                     outcome.pair.second, outcome.pair.distance, outcome.time);
    else if (outcome.ending == Ending::pursuit)
        outcome.reason =
            fmt::format("rods {} and {} share a heading and keep their distance of {:.6g}{}{}",
                        outcome.pair.first, outcome.pair.second, outcome.pair.distance,
                        outcome.grows.value_or(false) ? ", which still grows" : "",
                        outcome.stable.value_or(true) ? "" : "; rods in line are unstable there");
    else if (outcome.ending == Ending::orbit)
        outcome.reason = fmt::format("rods {} and {} orbit each other {:.6g} apart, once in a time of {:.6g}",
                                     outcome.pair.first, outcome.pair.second, outcome.separation,
                                     2.0 * std::numbers::pi / std::abs(outcome.omega));
    else if (outcome.ending == Ending::bound)
        outcome.reason = fmt::format("the bodies of rods {} and {} touch for most of the last quarter of the "
                                     "run; their centres are {:.6g} apart at its end",
                                     outcome.pair.first, outcome.pair.second, outcome.pair.distance);
    else if (outcome.ending == Ending::escape)
        outcome.reason = fmt::format("all rods part; rods {} and {} came closest, {:.6g} apart",
                                     outcome.pair.first, outcome.pair.second, outcome.min_separation);
    else
        outcome.reason = fmt::format("{} by t = {:.6g}; a longer t_end may decide",
                                     outcome.failed.empty() ? "no ending" : outcome.failed, outcome.time);
}

namespace {

/// A state with its time and rates.
struct Row {
    double time;
    std::vector<double> y, rates;
};

Row row_of(double time, const std::vector<double>& y, const std::vector<double>& turning) {
    Row row{time, y, std::vector<double>(y.size())};
    for (std::size_t a = 0; a < turning.size(); ++a) {
        row.rates[3 * a] = std::cos(y[3 * a + 2]);
        row.rates[3 * a + 1] = std::sin(y[3 * a + 2]);
        row.rates[3 * a + 2] = turning[a];
    }
    return row;
}

integrate::Step step_of(const Row& before, const Row& after) {
    return {before.time, after.time, before.y, after.y};
}

Row row_between(const Row& before, const Row& after, double time) {
    const double share = (time - before.time) / (after.time - before.time);
    std::vector<double> turning;
    for (std::size_t i = 2; i < before.y.size(); i += 3)
        turning.push_back((1.0 - share) * before.rates[i] + share * after.rates[i]);
    return row_of(time, state_at(time, step_of(before, after), before.rates, after.rates), turning);
}

/// Room for the rounding of a run that was stopped at contact.
bool in_contact(const Separation& pair, double distance) { return pair.distance <= distance * (1.0 + 1e-9); }

/// Cuts the rows at the first contact, if there is one: then the last is that of contact, the pair at its
/// distance.
bool cut_at_contact(std::vector<Row>& rows, double distance, Box box) {
    if (in_contact(closest_pair(rows.front().y, box), distance)) {
        rows.resize(1);
        return true;
    }
    for (std::size_t k = 1; k < rows.size(); ++k) {
        const Row &before = rows[k - 1], &after = rows[k];
        double outside = before.time, inside = after.time;
        if (!in_contact(closest_pair(after.y, box), distance)) {
            const auto approach = closest_approach(step_of(before, after), box, distance);
            if (!approach)
                continue;
            inside = approach->time;
        }
        for (int halving = 0; halving < 53; ++halving) {
            const double middle = 0.5 * (outside + inside);
            const Separation pair = closest_pair(row_between(before, after, middle).y, box);
            (in_contact(pair, distance) ? inside : outside) = middle;
        }
        Row met = row_between(before, after, inside);
        Separation pair = closest_pair(met.y, box);
        pair.distance = distance;
        put_apart(met.y, pair, box);
        rows.resize(k);
        rows.push_back(std::move(met));
        return true;
    }
    return false;
}

} // namespace

RodOutcome outcome_of(const RodTrack& track, std::optional<double> contact_distance, Box box,
                      bool interacting, const EndingCriteria& criteria) {
    const double first = track.times.front(), last = track.times.back();
    const double tail_start = last - criteria.steady_fraction * (last - first);

    // The way in chords is at most the time, and hardly below half of it however a rod turns: it would have
    // to turn by more than half a turn from row to row.
    const double time = last - first;
    for (std::size_t i = 0; i < track.states.front().size(); i += 3) {
        double way = 0.0;
        for (std::size_t k = 1; k < track.states.size(); ++k)
            way += std::hypot(track.states[k][i] - track.states[k - 1][i],
                              track.states[k][i + 1] - track.states[k - 1][i + 1]);
        if (!(way > 0.5 * time && way < 1.01 * time))
            throw InputError(fmt::format("poses: rod {} has walked {:.4g} in a time of {:.4g}; rods walk at "
                                         "speed 1: give lengths in f/mu and "
                                         "times in f/(mu v0), in rows that are less than half a turn apart",
                                         i / 3, way, time));
    }

    // Rows of the track, one at `tail_start` among them: there the last part begins.
    std::vector<Row> rows;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
        const Row row = row_of(track.times[k], track.states[k], track.turning[k]);
        if (!rows.empty() && rows.back().time < tail_start && tail_start < row.time)
            rows.push_back(row_between(rows.back(), row, tail_start));
        rows.push_back(row);
    }

    RodProblem problem;
    for (std::size_t a = 0; a < track.turning.front().size(); ++a)
        problem.rods.push_back(pose(rows.front().y, a));
    problem.box = box;
    SeparationRecord record = start_record(rows.front().y, tail_start, box);
    record.smallest_time = first;
    integrate::Solution solution;
    if (contact_distance && problem.rods.size() > 1 && cut_at_contact(rows, *contact_distance, box))
        solution.status.termination = integrate::Termination::stopped_at_event;
    const Row* at = nullptr;
    const StateRates rates = [&at](State, std::span<double> ydot) { // asked for at the ends of steps alone
        std::ranges::copy(at->rates, ydot.begin());
    };
    for (std::size_t k = 1; k < rows.size(); ++k) {
        at = &rows[k];
        add_step(record, step_of(rows[k - 1], rows[k]), rates, box);
    }
    at = &rows.back();
    solution.final_time = rows.back().time;
    solution.final_state = rows.back().y;
    return classify_outcome(problem, interacting, rates, solution, record, criteria);
}

} // namespace rodwake::rods
