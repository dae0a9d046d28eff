#include "rodwake/core/encounter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake {

namespace {

/// A criterion that a pair fails: its words, the pair's number and the limit. No words: it fails none.
struct FailedCriterion {
    const char* words = nullptr;
    double number = 0.0, limit = 0.0;

    std::string text() const { return words ? fmt::format(fmt::runtime(words), number, limit) : "met"; }
};

/// How far a rod at the offset (x, y) from one of this heading is off its axis; infinite unless it is behind.
double off_axis(double x, double y, double heading) {
    const double along = x * std::cos(heading) + y * std::sin(heading);
    const double across = y * std::cos(heading) - x * std::sin(heading);
    return along < 0.0 ? std::abs(across) : std::numeric_limits<double>::infinity();
}

FailedCriterion fails_pursuit(const PairEnd& pair, const EndingCriteria& limit) {
    if (!(pair.angle <= limit.locked_heading))
        return {"the headings differ by {:.3g} rad, limit {:g}", pair.angle, limit.locked_heading};
    const double low = pair.late.min_separation, high = pair.late.max_separation, mean = 0.5 * (low + high);
    if (!(high - low <= limit.steady_separation * mean))
        return {"the separation varied by {:.3g} of its mean at last, limit {:g}", (high - low) / mean,
                limit.steady_separation};
    const double r = std::hypot(pair.x, pair.y);
    const double aside =
        std::min(off_axis(pair.x, pair.y, pair.heading[1]), off_axis(-pair.x, -pair.y, pair.heading[0]));
    if (!(aside <= limit.lateral_offset * r))
        return {"the rear rod is {:.3g} of the separation off the axis, limit {:g}", aside / r,
                limit.lateral_offset};
    return {};
}

FailedCriterion fails_escape(const PairEnd& pair, const EndingCriteria& limit) {
    const double r = std::hypot(pair.x, pair.y), parting = std::hypot(pair.vx, pair.vy);
    const double rate = pair.x * pair.vx + pair.y * pair.vy; // times r
    if (!(rate > 0.0 && parting > 0.0))
        return {"the separation does not grow, its rate is {:.3g} of v0", rate / r};
    const double turning = pair.late.max_turning * r / parting;
    if (!(turning <= limit.residual_turn * pair.angle))
        return {
            "the separation grows, but the rods turn by {:.3g} of the angle between them while it doubles, "
            "limit {:g}",
            turning / pair.angle, limit.residual_turn};
    return {};
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
    if (!fails_pursuit(pair, criteria).words)
        return Ending::pursuit;
    return fails_escape(pair, criteria).words ? Ending::undecided : Ending::escape;
}

std::string failed_criteria(const PairEnd& pair, const EndingCriteria& criteria) {
    const FailedCriterion pursuit = fails_pursuit(pair, criteria);
    return fmt::format("no pursuit ({}), no escape ({})",
                       pursuit.words ? pursuit.text() : "the front rod's wake hardly reaches the rear one",
                       fails_escape(pair, criteria).text());
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
