#include "rodwake/rods/separation_record.hpp"

#include "within_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void keep_smaller(SeparationRecord& record, const Separation& pair, double time) {
    if (pair.distance < record.smallest.distance) {
        record.smallest = pair;
        record.smallest_time = time;
    }
}

void add_late(SeparationRecord& record, integrate::State y, integrate::State ydot, Box box) {
    const std::size_t rods = y.size() / 3;
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b) {
            const Offset d = offset(y, a, b, box);
            const double r = std::hypot(d.x, d.y);
            LatePart& range = record.late[a * rods + b];
            range = {std::min(range.min_separation, r), std::max(range.max_separation, r),
                     std::max({range.max_turning, std::abs(ydot[3 * a + 2]), std::abs(ydot[3 * b + 2])})};
        }
}

void add_late_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box) {
    std::vector<double> rate(step.state.size()), other(step.state.size());
    rates(step.state, rate);
    if (step.time_before < record.late_from && record.late_from < step.time) {
        rates(step.state_before, other);
        const auto y = state_at(record.late_from, step, other, rate);
        rates(y, other);
        add_late(record, y, other, box);
    }
    add_late(record, step.state, rate, box);
}

} // namespace

SeparationRecord start_record(integrate::State y, double late_from, Box box) {
    const std::size_t rods = y.size() / 3;
    if (rods < 2)
        return {{0, 0, infinity}, 0.0, late_from, {}};
    const std::size_t followed = rods <= most_followed_rods ? rods * rods : 0;
    return {closest_pair(y, box), 0.0, late_from, std::vector<LatePart>(followed, {infinity, 0.0, 0.0})};
}

void add_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box) {
    if (step.state.size() < 6)
        return;
    keep_smaller(record, closest_pair(step.state, box), step.time);
    if (const auto approach = closest_approach(step, box, record.smallest.distance))
        keep_smaller(record, approach->pair, approach->time);
    if (step.time >= record.late_from && !record.late.empty())
        add_late_step(record, step, rates, box);
}

} // namespace rodwake::rods
