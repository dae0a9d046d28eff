#include "pair_outcome.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;

void want_column(const Row& column, std::size_t rows) {
    if (column.size() != rows)
        throw InputError(
            fmt::format("measure: pair: a column of {} rows in a track of {} times", column.size(), rows));
    if (!std::ranges::all_of(column, [](double v) { return std::isfinite(v); }))
        throw InputError("measure: pair: a track with values that are not finite");
}

void want_positive(const char* what, double value) {
    if (!(std::isfinite(value) && value > 0.0))
        throw InputError(fmt::format("measure: pair, {} {:g}: must be finite and positive", what, value));
}

void check(const PairTrack& track, const PairKeys& keys) {
    want_positive("box (m)", keys.box);
    want_positive("contact distance (m)", keys.contact_distance);
    want_positive("lock angle (rad)", keys.lock_angle);
    if (track.t.size() < 2)
        throw InputError(fmt::format("measure: pair: a track of {} rows: needs 2 or more", track.t.size()));
    want_column(track.t, track.t.size());
    for (const auto* columns : {&track.x, &track.y, &track.heading})
        for (const Row& column : *columns)
            want_column(column, track.t.size());
    const auto back = std::ranges::adjacent_find(track.t, std::ranges::greater_equal());
    if (back != track.t.end())
        throw InputError(fmt::format("measure: pair: {:g} s follows {:g} s in a track: times must grow",
                                     back[1], back[0]));
}

/// Turn of a rod from the first row to each, whole turns counted.
Row turns(const Row& heading) {
    Row turn = {0.0};
    for (std::size_t row = 1; row < heading.size(); ++row)
        turn.push_back(turn.back() + std::remainder(heading[row] - heading[row - 1], 2.0 * std::numbers::pi));
    return turn;
}

/// +1 if the other rod is first to the left of rod i, -1 to its right: a turn there is towards it.
double side_of_other(const PairTrack& track, const PairKeys& keys, int i) {
    const Apart d = apart(track, keys.box, 0);
    const double away = i == 0 ? -1.0 : 1.0, heading = track.heading[i][0];
    return std::copysign(1.0, away * (std::cos(heading) * d.y - std::sin(heading) * d.x));
}

/// The frame of the first headings' mean: how far apart across it, and how far along it, in each row.
struct Course {
    bool common = false; ///< whether there is a mean heading
    Row across, ahead;   ///< of rod 0 seen from rod 1
    Row advanced;        ///< mean of both since the first row
};

Course course(const PairTrack& track, const PairKeys& keys) {
    double cx = std::cos(track.heading[0][0]) + std::cos(track.heading[1][0]);
    double cy = std::sin(track.heading[0][0]) + std::sin(track.heading[1][0]);
    const double length = std::hypot(cx, cy);
    if (length < 1e-6) // as the granular record has it
        return {};
    cx /= length;
    cy /= length;
    Course c{true, {}, {}, {}};
    for (std::size_t row = 0; row < track.t.size(); ++row) {
        const Apart d = apart(track, keys.box, row);
        c.across.push_back(cx * d.y - cy * d.x);
        c.ahead.push_back(cx * d.x + cy * d.y);
        const auto gone = [&](const Row(&place)[2]) {
            return (place[0][row] - place[0][0] + place[1][row] - place[1][0]) / 2.0;
        };
        c.advanced.push_back(cx * gone(track.x) + cy * gone(track.y));
    }
    return c;
}

double outward(const Course& c, std::size_t row) {
    return std::copysign(1.0, c.across[0]) * (c.across[row] - c.across[0]);
}

/// Straight between the rows on both sides of half a box.
std::optional<double> half_box_change(const Course& c, double box) {
    const auto there = std::ranges::find_if(c.advanced, [&](double way) { return way >= box / 2.0; });
    if (there == c.advanced.end())
        return std::nullopt;
    const auto row = static_cast<std::size_t>(there - c.advanced.begin()); // not the first, which is 0
    const double before = c.advanced[row - 1];
    const double part = (box / 2.0 - before) / (c.advanced[row] - before);
    return outward(c, row - 1) + part * (outward(c, row) - outward(c, row - 1));
}

void set_course(PairRun& run, const PairTrack& track, const PairKeys& keys, const Row (&turn)[2]) {
    const Course c = course(track, keys);
    const double distance = image_distance(track, keys.box, 0);
    run.separation = c.common && !run.perpendicular ? std::abs(c.across[0]) : distance;
    if (!c.common)
        return;
    run.half_box_change = half_box_change(c, keys.box);
    run.last_change = outward(c, track.t.size() - 1);
    std::size_t most = 0;
    for (std::size_t row = 0; row < track.t.size(); ++row)
        if (std::abs(turn[0][row]) + std::abs(turn[1][row]) >
            std::abs(turn[0][most]) + std::abs(turn[1][most]))
            most = row;
    run.leader = c.ahead[most] >= 0.0 ? 0 : 1;
    const double front = std::abs(turn[run.leader].back()), rear = std::abs(turn[1 - run.leader].back());
    if (front + rear > 1e-9) // rad
        run.non_reciprocity = (rear - front) / (rear + front);
}

} // namespace

PairRun follow_pair(const PairTrack& track, const PairKeys& keys) {
    check(track, keys);
    PairRun run;
    const double between =
        std::abs(std::remainder(track.heading[0][0] - track.heading[1][0], 2.0 * std::numbers::pi));
    run.perpendicular = between > std::numbers::pi / 3.0 && between < 2.0 * std::numbers::pi / 3.0;
    const Row turn[2] = {turns(track.heading[0]), turns(track.heading[1])};
    for (const int i : {0, 1})
        run.turn[i] = side_of_other(track, keys, i) * turn[i].back();
    set_course(run, track, keys, turn);
    run.min_separation = image_distance(track, keys.box, 0);
    for (std::size_t row = 1; row < track.t.size(); ++row)
        run.min_separation = std::min(run.min_separation, image_distance(track, keys.box, row));
    const Ending end = ending(track, keys);
    run.outcome = end.outcome;
    run.outcome_time = end.time;
    return run;
}

PairResult reduce(std::span<const PairRun> runs) {
    if (runs.empty())
        throw InputError("measure: pair: no runs");
    PairResult result;
    result.runs.assign(runs.begin(), runs.end());
    Row changes, index, rear, front;
    for (const PairRun& run : runs) {
        if (run.half_box_change)
            changes.push_back(*run.half_box_change);
        index.push_back(run.non_reciprocity);
        rear.push_back(run.turn[1 - run.leader]);
        front.push_back(run.turn[run.leader]);
        ++(run.outcome == PairOutcome::contact   ? result.contact
           : run.outcome == PairOutcome::pursuit ? result.pursuit
                                                 : result.escape);
    }
    result.half_box_change = mean_of_blocks(changes);
    result.not_there = runs.size() - changes.size();
    result.non_reciprocity = mean_of_blocks(index);
    result.turn_rear = mean_of_blocks(rear);
    result.turn_front = mean_of_blocks(front);
    return result;
}

} // namespace rodwake::measure
