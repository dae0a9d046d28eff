#include "slip.hpp"

#include "rodwake/core/error.hpp"
#include "slip_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace rodwake::granular {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

void advance(NormalMotion& motion, double rate, double impulse) {
    motion.regained += impulse * (motion.velocity + 0.5 * rate * impulse);
    motion.velocity += rate * impulse;
}

} // namespace

void NormalMotion::turn() {
    velocity = 0.0;
    compression -= std::min(regained, 0.0);
    regained = std::max(regained, 0.0);
}

SlipPiece follow_straight(NormalMotion& motion, double rate, double length, double restitution) {
    const double compressing = motion.velocity >= 0.0 ? 0.0 : rate > 0.0 ? -motion.velocity / rate : endless;
    if (compressing > length) {
        advance(motion, rate, length);
        return {length, false};
    }
    if (motion.velocity < 0.0) {
        motion.regained += 0.5 * motion.velocity * compressing;
        motion.turn();
    }
    const double wanted = motion.wanted(restitution);
    double restoring = 0.0;
    if (wanted > 0.0) {
        // The smallest p >= 0 with velocity p + rate p^2/2 = wanted, without cancellation for either sign of
        // the rate.
        const double square = motion.velocity * motion.velocity + 2.0 * rate * wanted;
        restoring = square < 0.0 ? endless : 2.0 * wanted / (motion.velocity + std::sqrt(square));
    }
    if (compressing + restoring <= length)
        return {compressing + restoring, true};
    advance(motion, rate, length - compressing);
    return {length, false};
}

namespace {

// Linear algebra of zero slip: 2x2 systems solved to rounding, and the direction in which slip goes on.

/// a b - c d by Kahan's method: error of 1.5 units in the last place at most (Jeannerod, Louvet, Muller
/// 2013).
double difference_of_products(double a, double b, double c, double d) {
    const double cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// xx yy - xy^2, relative error of a few units in the last place.
double determinant(double xx, double xy, double yy) { return difference_of_products(xx, yy, xy, xy); }

/// A^-1 b, each component to a few units in the last place however near A is to singular.
Eigen::Vector2d solve(const Eigen::Matrix2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d adjugate(difference_of_products(a(1, 1), b.x(), a(0, 1), b.y()),
                                   difference_of_products(a(0, 0), b.y(), a(0, 1), b.x()));
    return adjugate / determinant(a(0, 0), a(0, 1), a(1, 1));
}

/// Newton on 1/|s(lambda)| - 1, concave and rising: from below it converges without overshoot, in three or
/// four steps. lambda >= |q| - mu tr A because |q| <= lambda + mu |A|.
/// The s with (lambda + mu A) s = q, |s| = 1, lambda > 0: slip along it grows, dr/dp = lambda, and keeps its
/// direction. There is exactly one if |A^-1 q| > mu.
Eigen::Vector2d resumed_direction(const ContactTerms& contact) {
    const Eigen::Matrix2d drag = contact.friction * contact.tangential;
    double lambda = std::max(0.0, contact.coupling.norm() - drag.trace());
    Eigen::Vector2d s;
    for (int k = 0; k < 100; ++k) { // every step at least halves the distance; ends at rounding long before
        const Eigen::Matrix2d shifted = drag + lambda * Eigen::Matrix2d::Identity();
        s = solve(shifted, contact.coupling);
        const double length = s.norm();
        const double step = (length - 1.0) * length * length / s.dot(solve(shifted, s));
        if (!(std::abs(length - 1.0) > 2.0 * std::numeric_limits<double>::epsilon() &&
              lambda + step > lambda))
            break;
        lambda += step;
    }
    return s.normalized();
}

/// Of scale: h below this is rounding of q, A and s.
constexpr double rounding = 4.0 * std::numeric_limits<double>::epsilon();

/// g, h and dh/dphi of a direction.
struct DirectionRates {
    double growth, turn, slope;
};

DirectionRates turning(const ContactTerms& contact, const Eigen::Vector2d& s) {
    const Eigen::Vector2d rate = contact.slip_rate(s), t(-s.y(), s.x());
    const double growth = s.dot(rate);
    return {growth, t.dot(rate), -growth - contact.friction * t.dot(product(contact.tangential, t))};
}

void add_piece(const ContactTerms& contact, ImpactProgress& at, const Eigen::Vector2d& pull, double rate,
               double length) {
    if (!(length < endless || rate > 0.0))
        throw RunError("impact: friction holds the bodies together without end; the inverse mass is not "
                       "positive definite to rounding (see Impact in rodwake/granular/impact.hpp)");
    const SlipPiece piece = follow_straight(at.normal, rate, length, contact.restitution);
    at.tangential_impulse += piece.impulse * pull;
    at.normal_impulse += piece.impulse;
    at.ended = piece.ended;
}

} // namespace

ContactTerms::ContactTerms(const Eigen::Matrix2d& a, const Eigen::Vector2d& q, const Surface& surface)
    : tangential(a), coupling(q), friction(surface.friction), restitution(surface.restitution),
      scale(q.lpNorm<1>() + friction * a.trace()),
      tolerance(1e-14 * determinant(a(0, 0), a(0, 1), a(1, 1)) / a.trace()) {}

namespace {

using slip::SlipPath, slip::SlipSeries;

/// Whether the path turns on from here: it slips, and its direction has not settled. A direction has settled
/// if h is rounding; or if in what is left of a dying slip, p = r/(-g), it turns v_t by no more than counts;
/// or if the root that attracts it is so near that v_t may be moved there. Without the last, a path that has
/// settled but neither grows nor dies would be followed in steps of its fast time scale.
bool turns_on(const SlipPath& path) {
    const ContactTerms& contact = *path.contact;
    ImpactProgress& at = *path.at;
    const bool slips = at.speed > contact.tolerance;
    if (!slips)
        at.speed = 0.0;
    if (at.ended || !slips)
        return false;
    const DirectionRates now = turning(contact, at.direction);
    const double turn = std::abs(now.turn);
    if (turn <= rounding * contact.scale || turn * at.speed <= -now.growth * contact.tolerance)
        return false;
    if (turn * std::max(at.speed, 1e3 * contact.tolerance) <= -now.slope * contact.tolerance) {
        Eigen::Vector2d& s = at.direction; // onto the root of h next to it
        for (int k = 0; k < 3; ++k) {      // Newton, from a distance of 1e-3 at most
            const DirectionRates here = turning(contact, s);
            s = (s - here.turn / here.slope * Eigen::Vector2d(-s.y(), s.x())).normalized();
        }
        return false;
    }
    if (++at.steps > most_slip_steps)
        throw RunError("impact: the slip was not followed to its end in " + std::to_string(most_slip_steps) +
                       " steps; the inverse mass is not positive definite or not finite");
    return true;
}

/// Follows slips while their directions turn. Afterwards an impact has ended, or its speed is 0, or its
/// direction is a root of h to rounding. Throws RunError after `most_slip_steps`.
void slide_curved(std::span<SlipPath> paths) {
    constexpr std::size_t lanes = 4;
    for (;;) {
        paths = paths.first(static_cast<std::size_t>(
            std::remove_if(paths.begin(), paths.end(), [](const SlipPath& path) { return !turns_on(path); }) -
            paths.begin()));
        if (paths.empty())
            return;
        std::array<SlipPath, lanes> some{};
        std::size_t count = 0;
        for (const SlipPath& path : paths) {
            if (SlipSeries<1>::can_fall(*path.contact)) {
                SlipSeries<1>({path}).take();
                continue;
            }
            some[count++] = path;
            if (count == lanes) {
                SlipSeries<lanes>(some).take();
                count = 0;
            }
        }
        if (count == 1)
            SlipSeries<1>({some[0]}).take();
        if (count < 2)
            continue;
        std::array<ImpactProgress, lanes> idle;
        for (std::size_t lane = count; lane < lanes; ++lane) {
            idle[lane] = *some[0].at;
            some[lane] = {some[0].contact, &idle[lane]};
        }
        SlipSeries<lanes>(some).take();
    }
}

/// Follows an impact to its end once its slip does not turn. Throws RunError if K is not positive definite.
void go_on_straight(const ContactTerms& contact, ImpactProgress& at) {
    if (!at.ended && at.speed > 0.0) {
        // Slip along a root of h, until it stops or the impact ends.
        const double growth = at.direction.dot(contact.slip_rate(at.direction));
        const double to_stop = growth < 0.0 ? -at.speed / growth : endless;
        add_piece(contact, at, -contact.friction * at.direction, contact.normal_rate(at.direction), to_stop);
        at.speed = 0.0;
    }
    if (at.ended)
        return;
    // From zero slip to the end: stick, or slip in the one direction in which it grows.
    const Eigen::Vector2d hold = solve(contact.tangential, contact.coupling);
    if (hold.norm() <= contact.friction) {
        add_piece(contact, at, -hold, 1.0 - contact.coupling.dot(hold), endless);
        return;
    }
    const Eigen::Vector2d s = resumed_direction(contact);
    add_piece(contact, at, -contact.friction * s, contact.normal_rate(s), endless);
}

} // namespace

void follow_impact(const ContactTerms& contact, ImpactProgress& at) {
    SlipPath path{&contact, &at};
    slide_curved(std::span(&path, 1));
    go_on_straight(contact, at);
}

void follow_impacts(std::span<const ContactTerms> contacts, std::span<ImpactProgress> at) {
    std::vector<SlipPath> paths;
    for (std::size_t i = 0; i < at.size(); ++i)
        paths.push_back({&contacts[i], &at[i]});
    slide_curved(paths);
    for (std::size_t i = 0; i < at.size(); ++i)
        go_on_straight(contacts[i], at[i]);
}

} // namespace rodwake::granular
