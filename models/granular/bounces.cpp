#include "bounces.hpp"

#include "bodies.hpp"
#include "fixed_order.hpp"
#include "rodwake/core/repeatable_math.hpp"
#include "touches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

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

/// A rod on its way through one step.
class RodFall {
public:
    RodFall(MovingRod& rod, const PlateStep& step, const Surface& surface, const RodMoved& moved)
        : rod_(rod), step_(step), surface_(surface), moved_(moved), flight_(rod) {
        if (!(calm_ && lies_still(rod, step)))
            return;
        rod.stop();
        left_ = 0.0;
        momentum_.z() = rod.clump().mass * step.gravity * step.time_step;
        upward_.push_back({1.0, momentum_.z()});
    }

    /// Goes on to the next impact, whose impulse is then wanted; nullptr: the step is over.
    const ImpactCase* next_impact() {
        // two ends that rest push each other: an impulse leaves a quarter of the approach to the next round
        const int rounds = calm_ ? 12 : 1;
        for (;;) {
            while (place_ < places())
                if (touches(place_++))
                    return &impact_;
            if (++round_ < rounds && bounces_before_ != bounces_)
                start_round();
            else if (!fly())
                return nullptr;
        }
    }

    /// The impulse of the impact, in its frame.
    void take(const Vector3& impulse) { push(product(frame_, impulse)); }

    const Vector3& momentum() const { return momentum_; }
    void add_to(PlateTally& tally) const {
        for (const auto& [side, impulse] : upward_)
            Plate{side, &step_}.impulse(tally) += impulse;
        tally.impulses += bounces_;
        tally.max_overlap = std::max(tally.max_overlap, max_overlap_);
    }

private:
    std::size_t places() const { return 2 * rod_.outline().size(); }
    /// Spheres of the rod's outline at the floor, then at the lid.
    RodApproach approach(std::size_t place) const {
        const std::size_t count = rod_.outline().size();
        return {flight_, rod_.clump(), rod_.outline()[place % count], plates_[place / count]};
    }

    void look() {
        flight_ = RodFlight(rod_);
        const double floor = step_.floor.position(left_), speed = step_.floor.velocity(left_);
        plates_ = {PlateNow{{1.0, &step_}, left_, floor, speed},
                   PlateNow{{-1.0, &step_}, left_, floor + step_.gap, speed}};
    }

    /// To the next touch; false: the step is over.
    bool fly() {
        if (!(left_ > 0.0))
            return false;
        look();
        double next = never;
        for (std::size_t place = 0; place < places(); ++place)
            next = std::min(next, next_touch(approach(place), left_, rest_, lossless_));
        if (!acted_ || bounces_ >= most_rod_bounces)
            next = std::max(next, std::min(rest_, left_));
        rod_.move(std::min(next, left_), step_.gravity);
        if (next == never)
            return false;
        left_ = std::max(left_ - next, 0.0);
        acted_ = false;
        look();
        round_ = 0;
        start_round();
        return true;
    }

    void start_round() {
        bounces_before_ = bounces_;
        place_ = 0;
    }

    /// Whether an impact is to be followed there: the sphere is in contact and approaches.
    bool touches(std::size_t place) {
        const RodApproach now = approach(place);
        const PlateNow& then = plates_[place / rod_.outline().size()];
        const double gap = now.gap(), side = then.plate.side;
        if (!(gap <= touching * now.radius()))
            return false;
        max_overlap_ = std::max(max_overlap_, -gap / now.radius());
        const Vector3 normal(0.0, 0.0, side);
        arm_ = rod_.clump().offset[rod_.outline()[place % rod_.outline().size()]] * rod_.axis() -
               (now.radius() + gap) * normal;
        const Vector3 relative = rod_.velocity_at(arm_) - Vector3(0.0, 0.0, then.speed);
        const double approach = -relative.dot(normal);
        if (!(approach > 0.0))
            return false;
        const bool rests = !lossless_ && 2.0 * surface_.restitution * approach <
                                             std::max(now.pressing(), step_.gravity) * rest_;
        lift_ = rests && gap < 0.0 ? Vector3(-gap * normal) : Vector3(Vector3::Zero());
        side_ = side;
        const Eigen::Matrix3d inverse_mass = rod_.inverse_mass_at(arm_);
        if (rests && step_.still())
            if (const auto held = hold_or_slide(inverse_mass, relative, side, surface_.friction)) {
                push(*held);
                return false;
            }
        frame_ = contact_frame(normal);
        impact_ =
            seen_in(frame_, inverse_mass, relative, {surface_.friction, rests ? 0.0 : surface_.restitution});
        return true;
    }

    void push(const Vector3& impulse) {
        rod_.push(impulse, arm_);
        if (lift_.z() != 0.0)
            rod_.shift(lift_);
        upward_.emplace_back(side_, impulse.z());
        flight_ = RodFlight(rod_);
        momentum_ += impulse;
        acted_ = true;
        ++bounces_;
        moved_(rod_);
    }

    MovingRod& rod_;
    const PlateStep& step_;
    const Surface& surface_;
    const RodMoved& moved_;
    bool lossless_ = surface_.restitution == 1.0;
    /// Where plates are still and contacts lose energy nothing but the rod's own fall disturbs those that
    /// rest.
    bool calm_ = step_.still() && !lossless_;
    double rest_ = (calm_ ? 1.0 : rest_share) * step_.time_step;
    double left_ = step_.time_step; ///< of the step
    RodFlight flight_;
    std::array<PlateNow, 2> plates_{};
    std::size_t place_ = places();
    int round_ = 0, bounces_ = 0, bounces_before_ = 0;
    bool acted_ = true; ///< the last look gave an impulse; else time must pass
    ImpactCase impact_;
    Eigen::Matrix3d frame_;
    Vector3 arm_, lift_;
    double side_ = 1.0;
    Vector3 momentum_ = Vector3::Zero();
    std::vector<std::pair<double, double>> upward_; ///< side and impulse of each bounce
    double max_overlap_ = 0.0;
};

} // namespace

void fly_rods(std::span<MovingRod> rods, const PlateStep& step, const Surface& surface, PlateTally& tally,
              std::span<Vector3> momentum, const RodMoved& moved) {
    std::vector<RodFall> falls;
    falls.reserve(rods.size());
    for (MovingRod& rod : rods)
        falls.emplace_back(rod, step, surface, moved);
    // Rods do not meet here, so their impacts can be followed side by side.
    std::vector<std::size_t> flying(rods.size());
    std::iota(flying.begin(), flying.end(), std::size_t{0});
    std::vector<ImpactCase> cases;
    std::vector<Impact> impacts;
    while (!flying.empty()) {
        cases.clear();
        std::erase_if(flying, [&](std::size_t i) {
            const ImpactCase* impact = falls[i].next_impact();
            if (impact)
                cases.push_back(*impact);
            return !impact;
        });
        stronge_impacts(cases, impacts);
        for (std::size_t k = 0; k < flying.size(); ++k)
            falls[flying[k]].take(impacts[k].impulse);
    }
    for (std::size_t i = 0; i < rods.size(); ++i) {
        const double before = tally.max_overlap;
        falls[i].add_to(tally);
        momentum[i] += falls[i].momentum();
        if (tally.max_overlap > before)
            tally.deepest = i;
    }
}

} // namespace rodwake::granular
