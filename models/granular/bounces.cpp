#include "bounces.hpp"

#include "bodies.hpp"
#include "rodwake/core/repeatable_math.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace rodwake::granular {

// When two bodies in free flight touch: the root of the gap between them, which is known to lie between a
// time at which they are apart and one at which one is within the other. Newton's step where it stays between
// the two, their middle where it does not, so that a gap that curves the wrong way cannot lead it astray.

/// Root of gap(time) between `apart`, where gap > 0, and `within`, where gap <= 0; either may be the earlier.
/// slope(time) = d gap/dt. Stops when a step is no longer than `tolerance`: Newton doubles the digits with
/// each, so the error is about tolerance^2 gap''/(2 slope), then rounding.
template<class Gap, class Slope>
double touch_time(const Gap& gap, const Slope& slope, double apart, double within, double start,
                  double tolerance) {
    double time = start;
    for (int i = 0; i < 60; ++i) { // halving alone gives all digits in 53
        const double here = gap(time);
        (here > 0.0 ? apart : within) = time;
        const auto [low, high] = std::minmax(apart, within);
        const double newton = time - here / slope(time);
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
constexpr double shortest_hop = 0.05; // of a step

/// Distance of a bead in free flight from a plate as a polynomial in the time before the end of the step.
class Approach {
public:
    /// z and vz: at the end of the step.
    Approach(double z, double vz, double radius, const Plate& plate) {
        const std::array<double, 8>& floor = plate.step->floor.coefficients();
        for (std::size_t n = 0; n < c_.size(); ++n)
            c_[n] = -plate.side * floor[n];
        c_[0] += plate.side * (z - (plate.side > 0.0 ? 0.0 : plate.step->gap)) - radius;
        c_[1] -= plate.side * vz;
        c_[2] -= plate.side * plate.step->gravity / 2.0;
    }

    /// As if the plate were that much lower (the lid: higher).
    void lower_plate(double depth) { c_[0] += depth; }
    double gap_now() const { return c_[0]; }
    double opening_now() const { return -c_[1]; }
    // In pairs of terms, which do not wait for each other.
    double gap(double before) const {
        const double b2 = before * before, b4 = b2 * b2;
        return ((c_[0] + c_[1] * before) + (c_[2] + c_[3] * before) * b2) +
               ((c_[4] + c_[5] * before) + (c_[6] + c_[7] * before) * b2) * b4;
    }
    /// d gap/dt at that time: negative when approaching.
    double opening(double before) const {
        const double b2 = before * before, b4 = b2 * b2;
        return -(((c_[1] + 2.0 * c_[2] * before) + (3.0 * c_[3] + 4.0 * c_[4] * before) * b2) +
                 ((5.0 * c_[5] + 6.0 * c_[6] * before) + 7.0 * c_[7] * b2) * b4);
    }

private:
    std::array<double, 8> c_; ///< of before^n
};

/// The time since the touch were accelerations constant. Negative where there is no such time.
double rough_time_since_touch(double depth, double approach, double pressing) {
    const double inside = approach * approach - 2.0 * pressing * depth;
    return inside >= 0.0 ? 2.0 * depth / (approach + std::sqrt(inside)) : -1.0;
}

/// The last time the bead was clear of the plate: the start of its flight, or the top of its hop if it leaves
/// the plate there.
double last_clear(const Approach& approach, double back, double pressing) {
    const double leaving = approach.opening(back);
    if (!(leaving > 0.0 && pressing > 0.0))
        return back;
    return std::max(back - leaving / pressing, back / 2.0);
}

/// How long before the end of the step the bead, which has flown for `back`, touched the plate.
double time_since_touch(const Approach& approach, double back, const Plate& plate) {
    // Touching from the start on, or so soon that it makes no hop.
    const double pressing = std::max(plate.pressing(back), 0.0), soon = shortest_hop * back;
    if (approach.gap(back) <= pressing * soon * soon / 2.0 &&
        std::abs(approach.opening(back)) <= pressing * soon)
        return back;
    double apart = last_clear(approach, back, pressing), within = 0.0;
    double before = rough_time_since_touch(-approach.gap_now(), -approach.opening_now(), plate.pressing());
    if (!(before > within && before < apart))
        before = (within + apart) / 2.0;
    return touch_time([&](double time) { return approach.gap(time); },
                      [&](double time) { return -approach.opening(time); }, apart, within, before,
                      1e-8 * back); // what is left is rounding
}

/// Impulse on a bead from the plate given its velocity at the contact, applied to velocity and spin.
void push_bead(Bodies& bodies, std::size_t bead, const Plate& plate, double plate_speed,
               const Surface& surface, PlateTally& tally) {
    auto v = row(bodies.velocity, bead);
    auto w = row(bodies.spin, bead);
    const double a = bodies.bead_radius, per_mass = 1.0 / bodies.bead_mass,
                 k_t = per_mass + a * a / bodies.bead_inertia;
    // arm = -side a z; its spin velocity w x arm
    const Vector3 relative(v.x() - plate.side * a * w.y(), v.y() + plate.side * a * w.x(),
                           plate.side * (v.z() - plate_speed));
    const Vector3 p = uncoupled_impact(k_t, per_mass, relative, surface).impulse;
    v += per_mass * Vector3(p.x(), p.y(), plate.side * p.z());
    w += plate.side * a / bodies.bead_inertia * Vector3(p.y(), -p.x(), 0.0); // arm x P
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
    bodies.position[4 * bead + 2] = plate.height(before) + plate.side * bodies.bead_radius +
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

/// A bead inside a plate, which it flew into since `back` before the end of the step.
struct Intrusion {
    Plate plate;
    Approach approach;
};

/// None if the bead is in neither plate: the gap is wider than a bead, so it cannot be in both. What another
/// bead pushed into the plate leaves it by itself.
std::optional<Intrusion> intrusion(const Bodies& bodies, std::size_t bead, const PlateStep& step,
                                   double back) {
    const double z = bodies.position[4 * bead + 2], vz = bodies.velocity[4 * bead + 2];
    for (const double side : {1.0, -1.0}) {
        const Plate plate{side, &step};
        Approach approach(z, vz, bodies.bead_radius, plate);
        if (!(approach.gap_now() < 0.0))
            continue;
        approach.lower_plate(std::max(-approach.gap(back), 0.0));
        if (approach.gap_now() < 0.0)
            return Intrusion{plate, approach};
        return {};
    }
    return {};
}

void note_depth(PlateTally& tally, double depth, std::size_t bead) {
    if (depth > tally.deepest_flight) {
        tally.deepest_flight = depth;
        tally.deepest = bead;
    }
}

} // namespace

void bounce_bead(Bodies& bodies, std::size_t bead, const PlateStep& step, const Surface& surface,
                 Range& velocities, PlateTally& tally) {
    double back = step.time_step;
    for (int bounces = 0;; ++bounces) {
        const std::optional<Intrusion> found = intrusion(bodies, bead, step, back);
        if (!found)
            return;
        const auto& [plate, approach] = *found;
        note_depth(tally, -approach.gap_now() / bodies.bead_radius, bead);
        back = time_since_touch(approach, back, plate);
        const bool last = bounces == most_bounces;
        const bool rests =
            surface.restitution < 1.0 && (last || comes_to_rest(-approach.opening(back), plate.pressing(back),
                                                                plate, surface.restitution));
        if (rests)
            rest_until(bodies, bead, plate, lift_off(plate, back), surface, tally);
        else
            bounce_at(bodies, bead, plate, last ? 0.0 : back, surface, tally);
        velocities.include(&bodies.velocity[4 * bead]);
        if (rests || last)
            return;
    }
}

namespace {

constexpr double rest_share = 1.0 / 8.0; // of a step, between two impulses on a contact that rests
constexpr double touching = 1e-7;        // of a radius: nearer than that is in contact
constexpr int most_rod_bounces = 1000;   // within one step; later ones do not rebound

/// Distance between a sphere of a freely flying rod and a plate as time goes on.
class RodApproach {
public:
    RodApproach(const MovingRod& rod, std::size_t sphere, const Plate& plate, double left)
        : plate_(plate), left_(left), radius_(rod.clump().radius[sphere]), z_(rod.body().position.z()),
          vz_(rod.body().velocity.z()), arm_(rod.clump().offset[sphere]) {
        const Vector3 turning = rod.axis_turning();
        rate_ = turning.norm();
        const Vector3& axis = rod.axis();
        const Vector3 about = rate_ > 0.0 ? Vector3(turning / rate_) : Vector3(Vector3::Zero());
        kept_ = about.z() * about.dot(axis);
        swinging_ = axis.z() - kept_;
        crossing_ = about.x() * axis.y() - about.y() * axis.x();
    }

    /// m; negative inside the plate.
    double gap(double time) const {
        const auto [sine, cosine] = repeatable::sin_cos(rate_ * time);
        const double rise = kept_ + swinging_ * cosine + crossing_ * sine;
        const double height = z_ + vz_ * time - plate_.step->gravity * time * time / 2.0 + arm_ * rise;
        return plate_.side * (height - plate_.height(left_ - time)) - radius_;
    }
    /// d gap/dt.
    double opening(double time) const {
        const auto [sine, cosine] = repeatable::sin_cos(rate_ * time);
        const double rise = rate_ * (crossing_ * cosine - swinging_ * sine);
        return plate_.side * (vz_ - plate_.step->gravity * time + arm_ * rise - plate_.speed(left_ - time));
    }
    /// -d^2 gap/dt^2 now: positive where the sphere is pressed against the plate.
    double pressing() const { return plate_.pressing() + plate_.side * arm_ * rate_ * rate_ * swinging_; }
    double radius() const { return radius_; }
    double gravity() const { return plate_.step->gravity; }

private:
    Plate plate_;
    double left_, radius_, z_, vz_, arm_;
    double rate_, kept_, swinging_, crossing_; ///< z of the axis: kept + swinging cos + crossing sin
};

constexpr double never = std::numeric_limits<double>::infinity();

/// A lower bound of the gap for all times that count: rotation and plates change the acceleration little
/// within a step.
double least_gap(const RodApproach& approach, double left) {
    return approach.gap(0.0) + std::min(approach.opening(0.0), 0.0) * left -
           std::max(approach.pressing(), 0.0) * left * left;
}

/// Whether a sphere in contact stays there: what it moves by is what falling for `rest` adds.
bool stays(const RodApproach& approach, double rest, bool lossless) {
    const double opening = approach.opening(0.0);
    const double slowest = std::max(approach.pressing(), approach.gravity()) * rest;
    return lossless ? opening == 0.0 : -slowest <= opening && 2.0 * opening <= slowest;
}

/// When the gap, widened by `lift`, closes between a time outside and one inside.
double closing(const RodApproach& approach, double lift, double clear, double inside) {
    return touch_time([&](double time) { return approach.gap(time) + lift; },
                      [&](double time) { return approach.opening(time); }, clear, inside,
                      (clear + inside) / 2.0, 1e-15 * inside);
}

/// Of a sphere in contact on its way out: it comes back after the top of its hop, if at all within `left`.
double end_of_hop(const RodApproach& approach, double left) {
    const double lift = std::max(-approach.gap(0.0), 0.0), pressing = approach.pressing();
    if (!(pressing > 0.0) || approach.gap(left) + lift >= 0.0)
        return never;
    return closing(approach, lift, std::min(approach.opening(0.0) / pressing, left / 2.0), left);
}

/// Of a sphere outside: within `left`, be it that it grazes the plate on the way.
double first_touch(const RodApproach& approach, double left) {
    if (approach.gap(left) < 0.0)
        return closing(approach, 0.0, 0.0, left);
    const double pressing = approach.pressing();
    const double nearest = pressing < 0.0 ? approach.opening(0.0) / pressing : never;
    return nearest < left && approach.gap(nearest) < 0.0 ? closing(approach, 0.0, 0.0, nearest) : never;
}

/// When the sphere touches the plate next within `left`; a contact that rests is looked at again after
/// `rest`.
double next_touch(const RodApproach& approach, double left, double rest, bool lossless) {
    const double contact = touching * approach.radius();
    if (least_gap(approach, left) > contact)
        return never;
    if (!(approach.gap(0.0) <= contact))
        return first_touch(approach, left);
    if (stays(approach, rest, lossless))
        return std::min(rest, left);
    return approach.opening(0.0) <= 0.0 ? 0.0 : end_of_hop(approach, left);
}

Plate plate_at(const PlateStep& step, int side) { return {side == 0 ? 1.0 : -1.0, &step}; }

/// One impulse where the sphere touches, if it is in contact and approaches: the impulse.
std::optional<Vector3> bounce(MovingRod& rod, std::size_t sphere, const Plate& plate, double left,
                              double rest, const Surface& surface, PlateTally& tally) {
    const RodApproach now(rod, sphere, plate, left);
    const double gap = now.gap(0.0);
    if (!(gap <= touching * now.radius()))
        return {};
    tally.max_overlap = std::max(tally.max_overlap, -gap / now.radius());
    const Vector3 normal(0.0, 0.0, plate.side);
    const Vector3 arm = rod.clump().offset[sphere] * rod.axis() - (now.radius() + gap) * normal;
    const Vector3 relative = rod.velocity_at(arm) - Vector3(0.0, 0.0, plate.speed(left));
    const double approach = -relative.dot(normal);
    if (!(approach > 0.0))
        return {};
    const bool lossless = surface.restitution == 1.0;
    const bool rests = !lossless && 2.0 * surface.restitution * approach <
                                        std::max(now.pressing(), plate.step->gravity) * rest;
    const Surface acting{surface.friction, rests ? 0.0 : surface.restitution};
    const Vector3 impulse = impulse_along(normal, rod.inverse_mass_at(arm), relative, acting);
    rod.push(impulse, arm);
    if (rests && gap < 0.0)
        rod.shift(-gap * normal);
    plate.impulse(tally) += impulse.z();
    ++tally.impulses;
    return impulse;
}

/// Calls f(sphere, plate) for each sphere of the rod's outline at each plate.
template<class F>
void for_each_place(const MovingRod& rod, const PlateStep& step, const F& f) {
    for (const int side : {0, 1})
        for (const std::size_t sphere : rod.outline())
            f(sphere, plate_at(step, side));
}

} // namespace

Vector3 fly_rod(MovingRod& rod, const PlateStep& step, const Surface& surface, PlateTally& tally,
                const std::function<void()>& moved) {
    const bool lossless = surface.restitution == 1.0;
    const double rest = rest_share * step.time_step;
    double left = step.time_step;
    Vector3 got = Vector3::Zero();
    bool acted = true; // the last look gave an impulse; else time must pass
    for (int bounces = 0; left > 0.0;) {
        double next = never;
        for_each_place(rod, step, [&](std::size_t sphere, const Plate& plate) {
            next = std::min(next, next_touch(RodApproach(rod, sphere, plate, left), left, rest, lossless));
        });
        if (!acted || bounces >= most_rod_bounces)
            next = std::max(next, std::min(rest, left));
        rod.move(std::min(next, left), step.gravity);
        if (next == never)
            break;
        left = std::max(left - next, 0.0);
        acted = false;
        for_each_place(rod, step, [&](std::size_t sphere, const Plate& plate) {
            const auto impulse = bounce(rod, sphere, plate, left, rest, surface, tally);
            if (!impulse)
                return;
            got += *impulse;
            acted = true;
            ++bounces;
            moved();
        });
    }
    return got;
}

} // namespace rodwake::granular
