// What bounds of an encounter say of its ending: the criteria of core/encounter.hpp on intervals.

#include "pair_decision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::rods {

namespace {

using Truth = std::optional<bool>; ///< nothing: it may be either

/// Whether the value is at most the limit.
Truth at_most(Enclosure value, double limit) {
    if (value.high <= limit)
        return true;
    return value.low > limit ? Truth(false) : std::nullopt;
}

Truth both(Truth a, Truth b) {
    if (a == false || b == false)
        return false;
    return a && b ? Truth(true) : std::nullopt;
}

Truth negated(Truth a) { return a ? Truth(!*a) : std::nullopt; }
Truth either(Truth a, Truth b) { return negated(both(negated(a), negated(b))); }

Enclosure around(double value, double error) { return {value - error, value + error}; }

/// A rod at (x, y) from one of this heading sits behind it, within `limit` of its axis.
Truth follows(double x, double y, double heading, double error, double limit) {
    const double along = x * std::cos(heading) + y * std::sin(heading);
    const double across = y * std::cos(heading) - x * std::sin(heading);
    return at_most(around(std::atan2(std::abs(across), -along), error), std::asin(std::min(limit, 1.0)));
}

} // namespace

std::optional<Ending> certain_ending(const EncounterBounds& b, const EndingCriteria& criteria,
                                     const Feels& feels) {
    if (b.contact != EncounterBounds::Contact::none)
        return b.contact == EncounterBounds::Contact::certain ? std::optional(Ending::contact) : std::nullopt;
    const double r = std::hypot(b.x, b.y), angle = angle_between(b.heading[0], b.heading[1]),
                 turn = b.heading_error[0] + b.heading_error[1];

    // Pursuit: headings are locked, the distance is steady, and one rod is behind the other.
    const double s = 0.5 * criteria.steady_separation, aside = std::asin(std::min(1.0, b.place_error / r));
    const auto unsteady = [&](double low, double high) { return high - low - s * (low + high); };
    const Truth locked = at_most(around(angle, turn), criteria.locked_heading);
    const Truth steady = at_most(
        {unsteady(b.late_least.high, b.late_most.low), unsteady(b.late_least.low, b.late_most.high)}, 0.0);
    const Truth behind =
        either(follows(b.x, b.y, b.heading[1], aside + b.heading_error[1], criteria.lateral_offset),
               follows(-b.x, -b.y, b.heading[0], aside + b.heading_error[0], criteria.lateral_offset));
    const Truth pursuit = both(both(locked, steady), behind);
    if (!pursuit)
        return std::nullopt;
    if (*pursuit) { // if they feel each other, wherever they may be
        if (feels(r + b.place_error))
            return Ending::pursuit;
        return feels(std::max(0.0, r - b.place_error)) ? std::nullopt : std::optional(Ending::undecided);
    }

    // Escape: the rods part, and turn little beyond.
    const double vx = std::cos(b.heading[0]) - std::cos(b.heading[1]),
                 vy = std::sin(b.heading[0]) - std::sin(b.heading[1]), v = std::hypot(vx, vy);
    const Truth parting =
        negated(at_most(around(b.x * vx + b.y * vy, r * turn + (v + turn) * b.place_error), 0.0));
    if (v <= turn) // they may walk abreast
        return parting == false ? std::optional(Ending::undecided) : std::nullopt;
    const Enclosure beyond{
        b.late_turning.low * (r - b.place_error) / (v + turn) - criteria.residual_turn * (angle + turn),
        b.late_turning.high * (r + b.place_error) / (v - turn) - criteria.residual_turn * (angle - turn)};
    const Truth escape = both(parting, at_most(beyond, 0.0));
    return escape ? std::optional(*escape ? Ending::escape : Ending::undecided) : std::nullopt;
}

std::optional<Ending> together(std::span<const std::optional<Ending>> pairs) {
    const auto has = [&](std::optional<Ending> ending) { return std::ranges::count(pairs, ending) > 0; };
    for (const Ending first : {Ending::contact, Ending::pursuit})
        if (has(first))
            return first;
    if (has(Ending::undecided)) // escape is an ending of all
        return has(std::nullopt) ? std::nullopt : std::optional(Ending::undecided);
    return has(std::nullopt) ? std::nullopt : std::optional(Ending::escape);
}

} // namespace rodwake::rods
