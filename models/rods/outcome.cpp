#include "rodwake/rods/outcome.hpp"

#include "rodwake/rods/model.hpp"
#include "rodwake/rods/separation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

namespace {

using integrate::State;

double heading_difference(const Pose& a, const Pose& b) {
    return std::abs(std::remainder(a.heading - b.heading, 2.0 * std::numbers::pi));
}

/// A rod at the offset `behind` from `front` sits behind it, within `limit` of its axis.
bool follows(Offset behind, const Pose& front, double limit) {
    const double dx = behind.x, dy = behind.y, r = std::hypot(dx, dy);
    const double along = dx * std::cos(front.heading) + dy * std::sin(front.heading);
    const double across = dy * std::cos(front.heading) - dx * std::sin(front.heading);
    return along < 0.0 && std::abs(across) <= limit * r;
}

bool in_pursuit(const Pose& a, const Pose& b, Offset d, const PairHistory& history,
                const EndingCriteria& limit) {
    const double mean = 0.5 * (history.min_late + history.max_late);
    return heading_difference(a, b) <= limit.locked_heading &&
           history.max_late - history.min_late <= limit.steady_separation * mean &&
           (follows(d, b, limit.lateral_offset) || follows({-d.x, -d.y}, a, limit.lateral_offset));
}

bool escapes(State y, State ydot, std::size_t a, std::size_t b, const PairHistory& history,
             const EndingCriteria& limit, Box box) {
    const double rate = separation_rate(y, a, b, box);
    const double parting = std::hypot(ydot[3 * a] - ydot[3 * b], ydot[3 * a + 1] - ydot[3 * b + 1]);
    if (!(rate > 0.0 && parting > 0.0))
        return false;
    const Offset d = offset(y, a, b, box);
    const double r = std::hypot(d.x, d.y);
    const double turning =
        std::max({std::abs(ydot[3 * a + 2]), std::abs(ydot[3 * b + 2]), history.max_turning});
    return turning * r / parting <= limit.residual_turn;
}

} // namespace

Ending classify_pair(State y, State ydot, std::size_t a, std::size_t b, const PairHistory& history,
                     const EndingCriteria& criteria, Box box) {
    if (in_pursuit(pose(y, a), pose(y, b), offset(y, a, b, box), history, criteria))
        return Ending::pursuit;
    return escapes(y, ydot, a, b, history, criteria, box) ? Ending::escape : Ending::undecided;
}

std::string to_string(Ending ending) {
    switch (ending) {
    case Ending::contact:
        return "contact";
    case Ending::pursuit:
        return "pursuit";
    case Ending::escape:
        return "escape";
    case Ending::undecided:
        break;
    }
    return "undecided";
}

} // namespace rodwake::rods
