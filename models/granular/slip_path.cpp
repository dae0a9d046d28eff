#include "slip_path.hpp"

#include "rest_slip.hpp"
#include "rodwake/core/error.hpp"
#include "slip_series.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace rodwake::granular {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Of scale: h below this is rounding of q, A and s.
constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The path is curved where h is more than rounding and, in the rest of the slip, turns v_t by more than
/// counts: by at most h p, p = r/(-g).
bool is_curved(const ContactTerms& contact, const ImpactProgress& at, double rounding_of_h) {
    const Eigen::Vector2d rate = contact.slip_rate(at.direction);
    const double g = at.direction.dot(rate), h = std::abs(cross(at.direction, rate));
    return h > rounding_of_h && !(g < 0.0 && h * at.speed <= -g * contact.tolerance);
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
        if (!is_curved(contact, at, rounding * contact.scale))
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
