#include "rodwake/core/encounter.hpp"

#include <cmath>
#include <numbers>

namespace rodwake {

namespace {

/// A rod at the offset (x, y) from one of this heading sits behind it, within `limit` of its axis.
bool follows(double x, double y, double heading, double limit) {
    const double along = x * std::cos(heading) + y * std::sin(heading);
    const double across = y * std::cos(heading) - x * std::sin(heading);
    return along < 0.0 && std::abs(across) <= limit * std::hypot(x, y);
}

bool in_pursuit(const PairEnd& pair, const EndingCriteria& limit) {
    const double low = pair.late.min_separation, high = pair.late.max_separation;
    return pair.angle <= limit.locked_heading &&
           high - low <= limit.steady_separation * (0.5 * (low + high)) &&
           (follows(pair.x, pair.y, pair.heading[1], limit.lateral_offset) ||
            follows(-pair.x, -pair.y, pair.heading[0], limit.lateral_offset));
}

bool escapes(const PairEnd& pair, const EndingCriteria& limit) {
    const double r = std::hypot(pair.x, pair.y), parting = std::hypot(pair.vx, pair.vy);
    const double rate = pair.x * pair.vx + pair.y * pair.vy; // times r
    return rate > 0.0 && parting > 0.0 &&
           pair.late.max_turning * r / parting <= limit.residual_turn * pair.angle;
}

} // namespace

std::string to_string(Ending ending) {
    switch (ending) {
    case Ending::contact:
        return "contact";
    case Ending::pursuit:
        return "pursuit";
    case Ending::escape:
        return "escape";
    case Ending::orbit:
        return "orbit";
    case Ending::bound:
        return "bound";
    case Ending::undecided:
        break;
    }
    return "undecided";
}

std::string to_string(Certificate certificate) {
    return certificate == Certificate::verified  ? "verified"
           : certificate == Certificate::checked ? "checked"
                                                 : "open";
}

double angle_between(double heading, double other) {
    return std::abs(std::remainder(heading - other, 2.0 * std::numbers::pi));
}

Ending classify(const PairEnd& pair, const EndingCriteria& criteria) {
    if (in_pursuit(pair, criteria))
        return Ending::pursuit;
    return escapes(pair, criteria) ? Ending::escape : Ending::undecided;
}

PairFrame::PairFrame(double heading0, double heading1, double x, double y) {
    const double cx = std::cos(heading0) + std::cos(heading1), cy = std::sin(heading0) + std::sin(heading1);
    const double length = std::sqrt(cx * cx + cy * cy);
    if (length < 1e-6) // opposite to rounding
        return;
    common_ = true;
    ahead_x_ = cx / length;
    ahead_y_ = cy / length;
    first_ = across(x, y);
}

double PairFrame::separation() const { return std::abs(first_); }

double PairFrame::change(double x, double y) const { return std::copysign(1.0, first_) * across(x, y); }

} // namespace rodwake
