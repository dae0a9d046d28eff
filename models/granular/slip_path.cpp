#include "slip_path.hpp"

#include "rest_slip.hpp"
#include "rodwake/core/error.hpp"
#include "slip_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace rodwake::granular {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Of scale: h below this is rounding of q, A and s.
constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();

/// g, h and dh/dphi of a direction (slip_path.hpp).
struct Turning {
    double growth, turn, slope;
};

Turning turning(const ContactTerms& contact, const Eigen::Vector2d& s) {
    const Eigen::Vector2d rate = contact.slip_rate(s), t(-s.y(), s.x());
    const double growth = s.dot(rate);
    return {growth, t.dot(rate), -growth - contact.friction * t.dot(contact.tangential * t)};
}

/// Onto the root of h next to the direction.
void settle(const ContactTerms& contact, Eigen::Vector2d& s) {
    for (int k = 0; k < 3; ++k) { // Newton, from a distance of 1e-3 at most
        const Turning at = turning(contact, s);
        s = (s - at.turn / at.slope * Eigen::Vector2d(-s.y(), s.x())).normalized();
    }
}

/// Whether the direction has settled: h is rounding; or in what is left of a dying slip, p = r/(-g), it turns
/// v_t by no more than counts; or the root that attracts it is so near that v_t may be moved there. Without
/// the last, a path that has settled but neither grows nor dies would be followed in steps of its fast time
/// scale.
bool is_straight(const ContactTerms& contact, ImpactProgress& at) {
    const Turning now = turning(contact, at.direction);
    const double turn = std::abs(now.turn);
    if (turn <= rounding * contact.scale || turn * at.speed <= -now.growth * contact.tolerance)
        return true;
    if (!(turn * std::max(at.speed, 1e3 * contact.tolerance) <= -now.slope * contact.tolerance))
        return false;
    settle(contact, at.direction);
    return true;
}

[[noreturn]] void refuse_singular() {
    throw RunError("impact: friction holds the bodies together without end; the inverse mass is not positive "
                   "definite to rounding (see Impact in rodwake/granular/impact.hpp)");
}

void add_piece(const ContactTerms& contact, ImpactProgress& at, const Eigen::Vector2d& pull, double rate,
               double length) {
    if (!(length < never || rate > 0.0))
        refuse_singular();
    const Piece piece = follow_straight(at.normal, rate, length, contact.restitution);
    at.tangential_impulse += piece.impulse * pull;
    at.normal_impulse += piece.impulse;
    at.ended = piece.ended;
}

} // namespace

ContactTerms::ContactTerms(const Eigen::Matrix2d& a, const Eigen::Vector2d& q, const Surface& surface)
    : tangential(a), coupling(q), friction(surface.friction), restitution(surface.restitution),
      scale(q.lpNorm<1>() + friction * a.trace()),
      tolerance(1e-14 * determinant(a(0, 0), a(0, 1), a(1, 1)) / a.trace()) {}

void slide_curved(const ContactTerms& contact, ImpactProgress& at) {
    while (!at.ended && at.speed > contact.tolerance) {
        if (is_straight(contact, at))
            return;
        if (++at.steps > most_slip_steps)
            throw RunError("impact: the slip was not followed to its end in " +
                           std::to_string(most_slip_steps) +
                           " steps; the inverse mass is not positive definite or not finite");
        const SlipSeries series(contact, at);
        series.advance(at, series.stop());
    }
    if (!(at.speed > contact.tolerance))
        at.speed = 0.0;
}

void slide_straight(const ContactTerms& contact, ImpactProgress& at) {
    const double growth = at.direction.dot(contact.slip_rate(at.direction));
    const double to_stop = growth < 0.0 ? -at.speed / growth : never;
    add_piece(contact, at, -contact.friction * at.direction, contact.normal_rate(at.direction), to_stop);
    at.speed = 0.0;
}

void go_on_from_rest(const ContactTerms& contact, ImpactProgress& at) {
    const Eigen::Vector2d hold = solve(contact.tangential, contact.coupling);
    if (hold.norm() <= contact.friction) {
        add_piece(contact, at, -hold, 1.0 - contact.coupling.dot(hold), never);
        return;
    }
    const Eigen::Vector2d s = resumed_direction(contact);
    add_piece(contact, at, -contact.friction * s, contact.normal_rate(s), never);
}

void follow_impact(const ContactTerms& contact, ImpactProgress& at) {
    slide_curved(contact, at);
    if (!at.ended && at.speed > 0.0)
        slide_straight(contact, at);
    if (!at.ended)
        go_on_from_rest(contact, at);
}

} // namespace rodwake::granular
