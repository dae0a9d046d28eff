#include "rodwake/measure/pairs.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"

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

/// Turn of a rod from the first row to each, whole turns counted.
Row turns(const Row& heading) {
    Row turn = {0.0};
    for (std::size_t row = 1; row < heading.size(); ++row)
        turn.push_back(turn.back() + std::remainder(heading[row] - heading[row - 1], 2.0 * std::numbers::pi));
    return turn;
}

struct PairOffset {
    double x = 0.0, y = 0.0;
};

/// In which nearest images are taken: in twice the box nobody has one.
PeriodicBox images_of(const PairOptions& options) { return options.images ? options.box : options.box * 2.0; }

/// Rod 0 seen from rod 1, of the nearest images.
PairOffset apart(const PairTrack& track, const PeriodicBox& box, std::size_t row) {
    return {nearest_image(track.x[0][row] - track.x[1][row], box.x),
            nearest_image(track.y[0][row] - track.y[1][row], box.y)};
}

double separation(const PairTrack& track, const PeriodicBox& box, std::size_t row) {
    return nearest_distance(track.x[0][row] - track.x[1][row], track.y[0][row] - track.y[1][row], box);
}

/// What rod 0 has moved by relative to rod 1 from one row to another.
PairOffset moved(const PairTrack& track, std::size_t from, std::size_t to) {
    const auto step = [&](const Row(&place)[2]) {
        return place[0][to] - place[1][to] - place[0][from] + place[1][from];
    };
    return {step(track.x), step(track.y)};
}

/// How far the rods came along the mean first heading, mean of both.
double advanced(const PairTrack& track, const PairFrame& course, std::size_t row) {
    const auto sum = [&](const Row(&place)[2]) {
        return place[0][row] + place[1][row] - place[0][0] - place[1][0];
    };
    return course.ahead(sum(track.x), sum(track.y)) / 2.0;
}

double change(const PairTrack& track, const PairFrame& course, std::size_t row) {
    const PairOffset d = moved(track, 0, row);
    return course.change(d.x, d.y);
}

void set_course(PairRun& run, const PairTrack& track, const PeriodicBox& box, PairOffset first,
                const Row (&turn)[2]) {
    const PairFrame course(track.heading[0][0], track.heading[1][0], first.x, first.y);
    run.separation =
        course.common() && !run.perpendicular ? course.separation() : std::hypot(first.x, first.y);
    if (!course.common())
        return;

    // The change at half a box along the course, straight between the rows on both sides.
    const double half = course.side_along(box) / 2.0;
    for (std::size_t row = 1; row < track.t.size() && !run.half_box_change; ++row) {
        const double now = advanced(track, course, row);
        if (now < half)
            continue;
        const double before = advanced(track, course, row - 1);
        const double part = (half - before) / (now - before);
        const double last = change(track, course, row - 1);
        run.half_box_change = last + part * (change(track, course, row) - last);
    }
    run.last_change = change(track, course, track.t.size() - 1);

    // The leader is who was ahead when the pair had turned most.
    std::size_t most = 0;
    for (std::size_t row = 0; row < track.t.size(); ++row)
        if (std::abs(turn[0][row]) + std::abs(turn[1][row]) >
            std::abs(turn[0][most]) + std::abs(turn[1][most]))
            most = row;
    const PairOffset d = moved(track, 0, most);
    run.leader = course.ahead(first.x + d.x, first.y + d.y) >= 0.0 ? 0 : 1;
    const double front = std::abs(turn[run.leader].back()), rear = std::abs(turn[1 - run.leader].back());
    if (front + rear > 1e-9) // rad
        run.non_reciprocity = (rear - front) / (rear + front);
}

void set_ending(PairRun& run, const PairTrack& track, const PairOptions& options, const Row (&turn)[2]) {
    const PeriodicBox box = images_of(options);
    for (std::size_t row = 0; row < track.t.size(); ++row)
        if (separation(track, box, row) < options.contact_distance) {
            run.ending = Ending::contact;
            run.ending_time = track.t[row];
            return;
        }
    // The last part of a track begins at the last row but one at the latest.
    const double from = track.t.back() - options.ending.steady_fraction * (track.t.back() - track.t.front());
    const auto found = std::ranges::lower_bound(track.t, from) - track.t.begin();
    const std::size_t late = std::min(static_cast<std::size_t>(found), track.t.size() - 2);

    // core/encounter.hpp says what is a mean over the last part.
    const std::size_t last = track.t.size() - 1;
    const double duration = track.t[last] - track.t[late];
    const PairOffset position = apart(track, box, last), way = moved(track, late, last);
    PairEnd end;
    end.x = position.x;
    end.y = position.y;
    end.vx = way.x / duration;
    end.vy = way.y / duration;
    for (const int i : {0, 1}) {
        end.heading[i] = track.heading[i][last];
        end.late.max_turning =
            std::max(end.late.max_turning, std::abs(turn[i][last] - turn[i][late]) / duration);
    }
    end.late.min_separation = end.late.max_separation = std::hypot(position.x, position.y);
    for (std::size_t k = late; k <= last; ++k) {
        end.angle = std::max(end.angle, angle_between(track.heading[0][k], track.heading[1][k]));
        const double r = separation(track, box, k);
        end.late.min_separation = std::min(end.late.min_separation, r);
        end.late.max_separation = std::max(end.late.max_separation, r);
    }
    run.ending = classify(end, options.ending);

    // Pursuit begins when the headings lock for good.
    std::size_t row = track.t.size() - 1;
    while (row > 0 && angle_between(track.heading[0][row - 1], track.heading[1][row - 1]) <=
                          options.ending.locked_heading)
        --row;
    run.ending_time = run.ending == Ending::pursuit ? track.t[row] : track.t.back();
}

} // namespace

PairRun follow_pair(const PairTrack& track, const PairOptions& options) {
    const EndingCriteria& limit = options.ending;
    for (const auto& [what, value] :
         {std::pair("box (m)", options.box.x), std::pair("box (m)", options.box.y),
          std::pair("contact distance (m)", options.contact_distance),
          std::pair("locked heading (rad)", limit.locked_heading),
          std::pair("lateral offset", limit.lateral_offset),
          std::pair("steady separation", limit.steady_separation),
          std::pair("residual turn", limit.residual_turn),
          std::pair("last part of the track", limit.steady_fraction)})
        if (!(std::isfinite(value) && value > 0.0))
            throw InputError(fmt::format("measure: pair, {} {:g}: must be finite and positive", what, value));
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
    PairRun run;
    const double between = angle_between(track.heading[0][0], track.heading[1][0]);
    run.perpendicular = between > std::numbers::pi / 3.0 && between < 2.0 * std::numbers::pi / 3.0;
    const Row turn[2] = {turns(track.heading[0]), turns(track.heading[1])};
    const PeriodicBox images = images_of(options);
    const PairOffset first = apart(track, images, 0);
    for (const int i : {0, 1}) {
        // A turn counts as positive towards the side where the other rod is first.
        const double away = i == 0 ? -1.0 : 1.0, heading = track.heading[i][0];
        run.turn[i] = std::copysign(1.0, away * (std::cos(heading) * first.y - std::sin(heading) * first.x)) *
                      turn[i].back();
    }
    set_course(run, track, options.box, first, turn);
    run.min_separation = separation(track, images, 0);
    for (std::size_t row = 1; row < track.t.size(); ++row)
        run.min_separation = std::min(run.min_separation, separation(track, images, row));
    set_ending(run, track, options, turn);
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
        std::size_t* const counts[] = {&result.contact, &result.pursuit, &result.escape, &result.undecided};
        ++*counts[static_cast<std::size_t>(run.ending)];
    }
    result.half_box_change = mean_of_blocks(changes);
    result.not_there = runs.size() - changes.size();
    result.non_reciprocity = mean_of_blocks(index);
    result.turn_rear = mean_of_blocks(rear);
    result.turn_front = mean_of_blocks(front);
    return result;
}

} // namespace rodwake::measure
