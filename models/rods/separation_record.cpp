#include "rodwake/rods/separation_record.hpp"

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

void add_late(SeparationRecord& record, const integrate::Step& step, Box box) {
    const integrate::State y = step.state;
    const double duration = step.time - step.time_before;
    const std::size_t rods = y.size() / 3;
    const auto turning = [&](std::size_t rod) {
        return duration > 0.0 ? std::abs(y[3 * rod + 2] - step.state_before[3 * rod + 2]) / duration : 0.0;
    };
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b) {
            const Offset d = offset(y, a, b, box);
            const double r = std::hypot(d.x, d.y);
            LatePart& range = record.late[a * rods + b];
            range = {std::min(range.min_separation, r), std::max(range.max_separation, r),
                     std::max({range.max_turning, turning(a), turning(b)})};
        }
}

} // namespace

SeparationRecord start_record(integrate::State y, double late_from, Box box) {
    const std::size_t rods = y.size() / 3;
    if (rods < 2)
        return {{0, 0, infinity}, 0.0, late_from, {}};
    return {closest_pair(y, box), 0.0, late_from, std::vector<LatePart>(rods * rods, {infinity, 0.0, 0.0})};
}

void add_step(SeparationRecord& record, const integrate::Step& step, Box box) {
    if (record.late.empty())
        return;
    keep_smaller(record, closest_pair(step.state, box), step.time);
    if (const auto approach = closest_approach(step, box))
        keep_smaller(record, approach->pair, approach->time);
    if (step.time >= record.late_from)
        add_late(record, step, box);
}

} // namespace rodwake::rods
