#include "bounces.hpp"

#include "bodies.hpp"
#include "fixed_order.hpp"
#include "rodwake/core/repeatable_math.hpp"
#include "touches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace rodwake::granular {

// When two bodies in free flight touch: the root of the gap between them, which is known to lie between a
// time at which they are apart and one at which one is within the other. Newton's step where it stays between
// the two, their middle where it does not, so that a gap that curves the wrong way cannot lead it astray.

struct GapAndSlope {
    double gap, slope; ///< m; d gap/dt, m/s
};

/// Root of the gap of `flight`(time) between `apart`, where gap > 0, and `within`, where gap <= 0; either may
/// be the earlier. Stops when a step is no longer than `tolerance`: Newton doubles the digits with
/// each, so the error is about tolerance^2 gap''/(2 slope), then rounding.
template<class Flight>
double touch_time(const Flight& flight, double apart, double within, double start, double tolerance) {
    double time = start;
    for (int i = 0; i < 60; ++i) { // halving alone gives all digits in 53
        const auto [here, slope] = flight(time);
        (here > 0.0 ? apart : within) = time;
        const auto [low, high] = std::minmax(apart, within);
        const double newton = time - here / slope;
        const double next = newton >= low && newton <= high ? newton : (apart + within) / 2.0;
        if (std::abs(next - time) <= tolerance)
            return next;
        time = next;
    }
    return time;
}

namespace {

// Within one step; more come to rest or, without losses (nothing may take energy), turn round at its end.
constexpr int most_bounces = 16;

/// Impulse on a bead from the plate given its velocity at the contact, applied to velocity and spin.
void push_bead(Bodies& bodies, std::size_t bead, const Plate& plate, double plate_speed,
               const Surface& surface, PlateTally& tally) {
    auto v = row(bodies.velocity, bead);
    auto w = row(bodies.spin, bead);
    const double a = bodies.radius_of_bead(bead), per_mass = 1.0 / bodies.mass_of_bead(bead),
                 inertia = bodies.inertia_of_bead(bead), k_t = per_mass + a * a / inertia;
    // arm = -side a z; its spin velocity w x arm
    const Vector3 relative(v.x() - plate.side * a * w.y(), v.y() + plate.side * a * w.x(),
                           plate.side * (v.z() - plate_speed));
    const Vector3 p = uncoupled_impact(k_t, per_mass, relative, surface).impulse;
    v += per_mass * Vector3(p.x(), p.y(), plate.side * p.z());
    w += plate.side * a / inertia * Vector3(p.y(), -p.x(), 0.0); // arm x P
    plate.impulse(tally) += plate.side * p.z();
    ++tally.impulses;
}

/// Bounces `before` the end of the step, where it is then, and flies on to the end.
void bounce_at(Bodies& bodies, std::size_t bead, const Plate& plate, double before, const Surface& surface,
               PlateTally& tally) {
    auto v = row(bodies.velocity, bead);
    const Vector3 old = v;
    v.z() += plate.step->gravity * before;
    push_bead(bodies, bead, plate, plate.speed(before), surface, tally);
    v.z() -= plate.step->gravity * before;
    row(bodies.position, bead) += (v - old) * before;
}

/// Stays on the plate until that long before the end of the step.
void rest_until(Bodies& bodies, std::size_t bead, const Plate& plate, double before, const Surface& surface,
                PlateTally& tally) {
    bounce_at(bodies, bead, plate, before, {surface.friction, 0.0}, tally);
    const double vz = bodies.velocity[4 * bead + 2], gravity = plate.step->gravity;
    bodies.position[4 * bead + 2] = plate.height(before) + plate.side * bodies.radius_of_bead(bead) +
                                    (vz + gravity * before) * before - gravity * before * before / 2.0;
}

/// When the plate begins to run away from a bead that rests on it since `since`: how long before the end of
/// the step, or the end. Accelerations change evenly within a step, to a hundredth of that change.
double lift_off(const Plate& plate, double since) {
    const double then = plate.pressing(since), now = plate.pressing();
    return now >= 0.0 ? 0.0 : then > 0.0 ? since * now / (now - then) : since;
}

/// Whether a bead that touches with this speed hops for less than that: such hops add up to a rest on the
/// plate.
bool comes_to_rest(double touching_speed, double pressing, const Plate& plate, double restitution) {
    return 2.0 * restitution * touching_speed <
           std::max(pressing, plate.step->gravity) * shortest_hop * plate.step->time_step;
}

void note_flight(const Bodies& bodies, std::size_t bead, double back, Touches& touches, std::size_t k) {
    touches.z[k] = bodies.position[4 * bead + 2];
    touches.vz[k] = bodies.velocity[4 * bead + 2];
    touches.radius[k] = bodies.radius_of_bead(bead);
    touches.back[k] = back;
}

void note_depth(PlateTally& tally, double depth, std::size_t bead) {
    if (depth > tally.deepest_flight) {
        tally.deepest_flight = depth;
        tally.deepest = bead;
    }
}

bool in_a_plate(const Bodies& bodies, std::size_t bead, const PlateStep& step) {
    const double z = bodies.position[4 * bead + 2], a = bodies.radius_of_bead(bead),
                 floor = step.floor.position();
    return -floor + (z - a) < 0.0 || floor + (-(z - step.gap) - a) < 0.0; // to the bit as in touches.cpp
}

/// From its first touch on, which is the k-th. Few bounce again within the step.
void bounce_bead(Bodies& bodies, std::size_t bead, const PlateStep& step, const Surface& surface,
                 const Touches& first, std::size_t k, BodyRange& velocities, PlateTally& tally) {
    Touches again;
    const Touches* touch = &first;
    for (int bounces = 0; touch->side[k] != 0.0; ++bounces) {
        const Plate plate{touch->side[k], &step};
        const double back = touch->back[k];
        note_depth(tally, touch->depth[k] / bodies.radius_of_bead(bead), bead);
        const bool last = bounces == most_bounces;
        const bool rests =
            surface.restitution < 1.0 &&
            (last || comes_to_rest(touch->speed[k], plate.pressing(back), plate, surface.restitution));
        if (rests)
            rest_until(bodies, bead, plate, lift_off(plate, back), surface, tally);
        else
            bounce_at(bodies, bead, plate, last ? 0.0 : back, surface, tally);
        velocities.include(&bodies.velocity[4 * bead]);
        if (rests || last || !in_a_plate(bodies, bead, step))
            return;
        touch = &again;
        k = 0;
        note_flight(bodies, bead, back, again, k);
        find_touches(step, 1, again);
    }
}

} // namespace

void bounce_beads(Bodies& bodies, std::span<const std::uint32_t> beads, const PlateStep& step,
                  const Surface& surface, BodyRange& velocities, PlateTally& tally) {
    Touches touches;
    for (; !beads.empty(); beads = beads.subspan(std::min(beads.size(), Touches::most))) {
        const std::span<const std::uint32_t> some = beads.first(std::min(beads.size(), Touches::most));
        for (std::size_t k = 0; k < some.size(); ++k) {
            note_flight(bodies, some[k], step.time_step, touches, k);
            bodies.fetch(beads[std::min(k + Touches::most, beads.size() - 1)]);
        }
        find_touches(step, some.size(), touches);
        for (std::size_t k = 0; k < some.size(); ++k)
            bounce_bead(bodies, some[k], step, surface, touches, k, velocities, tally);
    }
}

namespace {

constexpr double rest_share = 1.0 / 8.0; // of a step, between two impulses on a contact that rests
constexpr double touching = 1e-7;        // of a radius: nearer than that is in contact
constexpr int most_rod_bounces = 1000;   // within one step; later ones do not rebound

/// Height and axis of a freely flying rod as time goes on; the same for all its spheres.
struct RodFlight {
    double z, vz;
    double rate, kept, swinging, crossing; ///< z of the axis: kept + swinging cos + crossing sin

    explicit RodFlight(const MovingRod& rod) : z(rod.body().position.z()), vz(rod.body().velocity.z()) {
        const Vector3 turning = rod.axis_turning();
        rate = turning.norm();
        const Vector3& axis = rod.axis();
        const Vector3 about = rate > 0.0 ? Vector3(turning / rate) : Vector3(Vector3::Zero());
        kept = about.z() * about.dot(axis);
        swinging = axis.z() - kept;
        crossing = about.x() * axis.y() - about.y() * axis.x();
    }
};

/// A plate, and where it is so long before the end of the step.
struct PlateNow {
    Plate plate;
    double left, height, speed;
};

/// Distance between a sphere of a freely flying rod and a plate as time goes on.
class RodApproach {
public:
    RodApproach(const RodFlight& flight, const Clump& clump, std::size_t sphere, const PlateNow& now)
        : flight_(flight), now_(now), radius_(clump.radius[sphere]), arm_(clump.offset[sphere]) {}

    /// Gap, m, negative inside the plate, and d gap/dt.
    GapAndSlope at(double time) const {
        const auto [sine, cosine] = repeatable::sin_cos(flight_.rate * time);
        const double before = now_.left - time;
        return {gap(time, sine, cosine, now_.plate.height(before)),
                opening(time, sine, cosine, now_.plate.speed(before))};
    }
    double gap(double time) const {
        const auto [sine, cosine] = repeatable::sin_cos(flight_.rate * time);
        return gap(time, sine, cosine, now_.plate.height(now_.left - time));
    }
    double gap() const { return gap(0.0, 0.0, 1.0, now_.height); }
    double opening() const { return opening(0.0, 0.0, 1.0, now_.speed); }
    /// -d^2 gap/dt^2 now: positive where the sphere is pressed against the plate.
    double pressing() const {
        return now_.plate.pressing() +
               now_.plate.side * arm_ * flight_.rate * flight_.rate * flight_.swinging;
    }
    double radius() const { return radius_; }
    double gravity() const { return now_.plate.step->gravity; }

private:
    double gap(double time, double sine, double cosine, double plate) const {
        const double rise = flight_.kept + flight_.swinging * cosine + flight_.crossing * sine;
        const double height = flight_.z + flight_.vz * time - gravity() * time * time / 2.0 + arm_ * rise;
        return now_.plate.side * (height - plate) - radius_;
    }
    double opening(double time, double sine, double cosine, double plate) const {
        const double rise = flight_.rate * (flight_.crossing * cosine - flight_.swinging * sine);
        return now_.plate.side * (flight_.vz - gravity() * time + arm_ * rise - plate);
    }

    const RodFlight& flight_;
    const PlateNow& now_;
    double radius_, arm_;
};

constexpr double never = std::numeric_limits<double>::infinity();

/// A lower bound of the gap for all times that count: rotation and plates change the acceleration little
/// within a step.
double least_gap(const RodApproach& approach, double left) {
    return approach.gap() + std::min(approach.opening(), 0.0) * left -
           std::max(approach.pressing(), 0.0) * left * left;
}

/// Whether a sphere in contact stays there: what it moves by is what falling for `rest` adds.
bool stays(const RodApproach& approach, double rest, bool lossless) {
    const double opening = approach.opening();
    const double slowest = std::max(approach.pressing(), approach.gravity()) * rest;
    return lossless ? opening == 0.0 : -slowest <= opening && 2.0 * opening <= slowest;
}

/// When the gap, widened by `lift`, closes between a time outside and one inside.
double closing(const RodApproach& approach, double lift, double clear, double inside) {
    const auto flight = [&](double time) {
        const GapAndSlope at = approach.at(time);
        return GapAndSlope{at.gap + lift, at.slope};
    };
    return touch_time(flight, clear, inside, (clear + inside) / 2.0, 1e-15 * inside);
}

/// Of a sphere in contact on its way out: it comes back after the top of its hop, if at all within `left`.
double end_of_hop(const RodApproach& approach, double left) {
    const double lift = std::max(-approach.gap(), 0.0), pressing = approach.pressing();
    if (!(pressing > 0.0) || approach.gap(left) + lift >= 0.0)
        return never;
    return closing(approach, lift, std::min(approach.opening() / pressing, left / 2.0), left);
}

/// Of a sphere outside: within `left`, be it that it grazes the plate on the way.
double first_touch(const RodApproach& approach, double left) {
    if (approach.gap(left) < 0.0)
        return closing(approach, 0.0, 0.0, left);
    const double pressing = approach.pressing();
    const double nearest = pressing < 0.0 ? approach.opening() / pressing : never;
    return nearest < left && approach.gap(nearest) < 0.0 ? closing(approach, 0.0, 0.0, nearest) : never;
}

/// When the sphere touches the plate next within `left`; a contact that rests is looked at again after
/// `rest`.
double next_touch(const RodApproach& approach, double left, double rest, bool lossless) {
    const double contact = touching * approach.radius();
    if (least_gap(approach, left) > contact)
        return never;
    if (!(approach.gap() <= contact))
        return first_touch(approach, left);
    if (stays(approach, rest, lossless))
        return std::min(rest, left);
    return approach.opening() <= 0.0 ? 0.0 : end_of_hop(approach, left);
}

/// A contact that rests on a plate at rest follows no impact. It gets the impulse that stops the point if
/// friction can hold it, else one that ends its approach and acts against the slip as it is now; nothing if
/// that would give energy.
std::optional<Vector3> hold_or_slide(const Eigen::Matrix3d& inverse_mass, const Vector3& relative,
                                     double side, double friction) {
    // K P = -v by Cramer's rule; K is symmetric
    const Vector3 x = inverse_mass.col(0), y = inverse_mass.col(1), z = inverse_mass.col(2);
    const Vector3 stop =
        Vector3(relative.dot(y.cross(z)), relative.dot(z.cross(x)), relative.dot(x.cross(y))) /
        -x.dot(y.cross(z));
    if (stop.head<2>().norm() <= friction * side * stop.z())
        return stop;
    const Eigen::Vector2d slip = relative.head<2>().normalized();
    const Vector3 along(-friction * slip.x(), -friction * slip.y(), side);
    const double gain = side * z.dot(along); // of speed away from the plate, for each unit of the impulse
    const Vector3 impulse = (-side * relative.z() / gain) * along;
    const Vector3 after = relative + product(inverse_mass, impulse);
    if (!(gain > 0.0 && impulse.dot(relative + after) <= 0.0))
        return {};
    return impulse;
}

/// One impulse where the sphere touches, if it is in contact and approaches: the impulse.
std::optional<Vector3> bounce(MovingRod& rod, std::size_t sphere, const RodApproach& now,
                              const PlateNow& then, double rest, const Surface& surface, PlateTally& tally) {
    const Plate& plate = then.plate;
    const double gap = now.gap();
    if (!(gap <= touching * now.radius()))
        return {};
    tally.max_overlap = std::max(tally.max_overlap, -gap / now.radius());
    const Vector3 normal(0.0, 0.0, plate.side);
    const Vector3 arm = rod.clump().offset[sphere] * rod.axis() - (now.radius() + gap) * normal;
    const Vector3 relative = rod.velocity_at(arm) - Vector3(0.0, 0.0, then.speed);
    const double approach = -relative.dot(normal);
    if (!(approach > 0.0))
        return {};
    const bool lossless = surface.restitution == 1.0;
    const bool rests = !lossless && 2.0 * surface.restitution * approach <
                                        std::max(now.pressing(), plate.step->gravity) * rest;
    const Surface acting{surface.friction, rests ? 0.0 : surface.restitution};
    const Eigen::Matrix3d inverse_mass = rod.inverse_mass_at(arm);
    std::optional<Vector3> held;
    if (rests && plate.step->still())
        held = hold_or_slide(inverse_mass, relative, plate.side, surface.friction);
    const Vector3 impulse = held ? *held : impulse_along(normal, inverse_mass, relative, acting);
    rod.push(impulse, arm);
    if (rests && gap < 0.0)
        rod.shift(-gap * normal);
    plate.impulse(tally) += impulse.z();
    ++tally.impulses;
    return impulse;
}

/// Calls f(sphere, plate) for each sphere of the rod's outline at each plate.
template<class F>
void for_each_place(const MovingRod& rod, const PlateStep& step, double left, const F& f) {
    const double floor = step.floor.position(left), speed = step.floor.velocity(left);
    for (const double side : {1.0, -1.0}) {
        const PlateNow plate{{side, &step}, left, floor + (side > 0.0 ? 0.0 : step.gap), speed};
        for (const std::size_t sphere : rod.outline())
            f(sphere, plate);
    }
}

/// Whether a rod lies on the floor of plates that are still: two places are no higher than a fall in one
/// step, and none is faster than such a fall makes it. Impulses one after the other leave that much, and
/// would have it creep on for ever; a rod that slides so slowly stops within g dt^2/(2 mu) (2e-6 m at 1e-4
/// s), but one that rolls would not.
bool lies_still(const MovingRod& rod, const PlateStep& step) {
    const double fall = step.gravity * step.time_step;
    int lying = 0;
    for (const std::size_t sphere : rod.outline()) {
        const Vector3 arm = rod.clump().offset[sphere] * rod.axis();
        if (!(rod.velocity_at(arm).norm() <= fall))
            return false;
        const double height = rod.body().position.z() + arm.z() - rod.clump().radius[sphere];
        lying += height <= step.floor.position() + fall * step.time_step / 2.0;
    }
    return lying > 1;
}

} // namespace

Vector3 fly_rod(MovingRod& rod, const PlateStep& step, const Surface& surface, PlateTally& tally,
                const std::function<void()>& moved) {
    const bool lossless = surface.restitution == 1.0;
    // where plates are still and contacts lose energy, nothing but the rod's own fall disturbs those that
    // rest
    const bool calm = step.still() && !lossless;
    if (calm && lies_still(rod, step)) {
        Vector3 weight(0.0, 0.0, rod.clump().mass * step.gravity * step.time_step);
        rod.stop();
        tally.floor_impulse += weight.z();
        return weight;
    }
    const int rounds = calm ? 12 : 1;
    const double rest = (calm ? 1.0 : rest_share) * step.time_step;
    double left = step.time_step;
    Vector3 got = Vector3::Zero();
    bool acted = true; // the last look gave an impulse; else time must pass
    for (int bounces = 0; left > 0.0;) {
        double next = never;
        RodFlight flight(rod);
        for_each_place(rod, step, left, [&](std::size_t sphere, const PlateNow& plate) {
            next = std::min(
                next, next_touch(RodApproach(flight, rod.clump(), sphere, plate), left, rest, lossless));
        });
        if (!acted || bounces >= most_rod_bounces)
            next = std::max(next, std::min(rest, left));
        rod.move(std::min(next, left), step.gravity);
        if (next == never)
            break;
        left = std::max(left - next, 0.0);
        acted = false;
        flight = RodFlight(rod);
        // two ends that rest push each other: an impulse leaves a quarter of the approach to the next round
        for (int round = 0, before = -1; round < rounds && before != bounces; ++round) {
            before = bounces;
            for_each_place(rod, step, left, [&](std::size_t sphere, const PlateNow& plate) {
                const RodApproach now(flight, rod.clump(), sphere, plate);
                const auto impulse = bounce(rod, sphere, now, plate, rest, surface, tally);
                if (!impulse)
                    return;
                flight = RodFlight(rod);
                got += *impulse;
                acted = true;
                ++bounces;
                moved();
            });
        }
    }
    return got;
}

} // namespace rodwake::granular
