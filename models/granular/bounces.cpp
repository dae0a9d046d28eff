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

namespace {

// Within one step; more come to rest or, without losses (nothing may take energy), turn round at its end.
constexpr int most_bounces = 16;

/// Bounces `before` the end of the step, where it is then, and flies on to the end.
void bounce_at(Bodies& bodies, std::size_t bead, const Plate& plate, double before, const Surface& surface,
               PlateTally& tally) {
    auto v = row(bodies.velocity, bead);
    auto w = row(bodies.spin, bead);
    const Vector3 old = v;
    v.z() += plate.step->gravity * before;
    const double a = bodies.radius_of_bead(bead), per_mass = 1.0 / bodies.mass_of_bead(bead),
                 inertia = bodies.inertia_of_bead(bead), k_t = per_mass + a * a / inertia;
    // arm = -side a z; its spin velocity w x arm
    const Vector3 relative(v.x() - plate.side * a * w.y(), v.y() + plate.side * a * w.x(),
                           plate.side * (v.z() - plate.speed(before)));
    const Vector3 p = uncoupled_impact(k_t, per_mass, relative, surface).impulse;
    v += per_mass * Vector3(p.x(), p.y(), plate.side * p.z());
    w += plate.side * a / inertia * Vector3(p.y(), -p.x(), 0.0); // arm x P
    plate.impulse(tally) += plate.side * p.z();
    ++tally.impulses;
    v.z() -= plate.step->gravity * before;
    row(bodies.position, bead) += (v - old) * before;
}

void note_flight(const Bodies& bodies, std::size_t bead, double back, Touches& touches, std::size_t k) {
    touches.z[k] = bodies.position[4 * bead + 2];
    touches.vz[k] = bodies.velocity[4 * bead + 2];
    touches.radius[k] = bodies.radius_of_bead(bead);
    touches.back[k] = back;
}

/// From its first touch on, which is the k-th. Few bounce again within the step.
void bounce_bead(Bodies& bodies, std::size_t bead, const PlateStep& step, const Surface& surface,
                 const Touches& first, std::size_t k, BodyRange& velocities, PlateTally& tally) {
    const double a = bodies.radius_of_bead(bead), gravity = step.gravity;
    double& z = bodies.position[4 * bead + 2];
    Touches again;
    const Touches* touch = &first;
    for (int bounces = 0; touch->side[k] != 0.0; ++bounces) {
        const Plate plate{touch->side[k], &step};
        const double back = touch->back[k], depth = touch->depth[k] / a;
        if (depth > tally.deepest_flight) {
            tally.deepest_flight = depth;
            tally.deepest = bead;
        }
        // Hops shorter than `shortest_hop` add up to a rest on the plate.
        const bool last = bounces == most_bounces;
        const double then = plate.pressing(back);
        const bool rests = surface.restitution < 1.0 &&
                           (last || 2.0 * surface.restitution * touch->speed[k] <
                                        std::max(then, gravity) * shortest_hop * step.time_step);
        if (rests) {
            // It stays until the plate begins to run away from it, or to the end of the step. Accelerations
            // change evenly within a step, to a hundredth of that change.
            const double now = plate.pressing(), before = now >= 0.0   ? 0.0
                                                          : then > 0.0 ? back * now / (now - then)
                                                                       : back;
            bounce_at(bodies, bead, plate, before, {surface.friction, 0.0}, tally);
            const double vz = bodies.velocity[4 * bead + 2];
            z = plate.height(before) + plate.side * a + (vz + gravity * before) * before -
                gravity * before * before / 2.0;
        } else {
            bounce_at(bodies, bead, plate, last ? 0.0 : back, surface, tally);
        }
        velocities.include(&bodies.velocity[4 * bead]);
        const double floor = step.floor.position();
        const bool in_a_plate =
            -floor + (z - a) < 0.0 || floor + (-(z - step.gap) - a) < 0.0; // to the bit as in touches.cpp
        if (rests || last || !in_a_plate)
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

struct GapAndSlope {
    double gap, slope; ///< m, negative inside the plate; d gap/dt, m/s
};

/// Distance between a sphere of a freely flying rod and a plate as time goes on.
struct RodApproach {
    const RodFlight& flight;
    const PlateNow& plate_now;
    double radius, arm;

    GapAndSlope at(double time, double sine, double cosine, double height, double speed) const {
        const double g = plate_now.plate.step->gravity, side = plate_now.plate.side;
        const double rise = flight.kept + flight.swinging * cosine + flight.crossing * sine,
                     rising = flight.rate * (flight.crossing * cosine - flight.swinging * sine);
        const double z = flight.z + flight.vz * time - g * time * time / 2.0 + arm * rise;
        return {side * (z - height) - radius, side * (flight.vz - g * time + arm * rising - speed)};
    }
    GapAndSlope at(double time) const {
        const auto [sine, cosine] = repeatable::sin_cos(flight.rate * time);
        const double before = plate_now.left - time;
        return at(time, sine, cosine, plate_now.plate.height(before), plate_now.plate.speed(before));
    }
    GapAndSlope now() const { return at(0.0, 0.0, 1.0, plate_now.height, plate_now.speed); }
    /// -d^2 gap/dt^2 now: positive where the sphere is pressed against the plate.
    double pressing() const {
        return plate_now.plate.pressing() +
               plate_now.plate.side * arm * flight.rate * flight.rate * flight.swinging;
    }
};

constexpr double never = std::numeric_limits<double>::infinity();

/// When the gap, widened by `lift`, closes between a time `apart` at which it is open and one `within` at
/// which it is not. Newton's step where it stays between the two, their middle where it does not, so that a
/// gap that curves the wrong way cannot lead it astray. Newton doubles the digits with each step, so the
/// error is about tolerance^2 gap''/(2 slope), then rounding.
double touch_time(const RodApproach& approach, double lift, double apart, double within) {
    const double tolerance = 1e-15 * within;
    double time = (apart + within) / 2.0;
    for (int i = 0; i < 60; ++i) { // halving alone gives all digits in 53
        const auto [gap, slope] = approach.at(time);
        const double here = gap + lift;
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

/// When the sphere touches the plate next within `left`; a contact that rests is looked at again after
/// `rest`.
double next_touch(const RodApproach& approach, double left, double rest, bool lossless) {
    const auto [gap, opening] = approach.now();
    const double contact = touching * approach.radius, pressing = approach.pressing();
    // A lower bound of the gap for all times that count: rotation and plates change the acceleration little
    // within a step.
    if (gap + std::min(opening, 0.0) * left - std::max(pressing, 0.0) * left * left > contact)
        return never;
    if (!(gap <= contact)) {
        // The first touch of a sphere outside, be it that it grazes the plate on the way.
        if (approach.at(left).gap < 0.0)
            return touch_time(approach, 0.0, 0.0, left);
        const double nearest = pressing < 0.0 ? opening / pressing : never;
        return nearest < left && approach.at(nearest).gap < 0.0 ? touch_time(approach, 0.0, 0.0, nearest)
                                                                : never;
    }
    // A sphere in contact stays there if it moves by no more than falling for `rest` adds.
    const double slowest = std::max(pressing, approach.plate_now.plate.step->gravity) * rest;
    if (lossless ? opening == 0.0 : -slowest <= opening && 2.0 * opening <= slowest)
        return std::min(rest, left);
    if (opening <= 0.0)
        return 0.0;
    // On its way out it comes back after the top of its hop, if at all within `left`.
    const double lift = std::max(-gap, 0.0);
    if (!(pressing > 0.0) || approach.at(left).gap + lift >= 0.0)
        return never;
    return touch_time(approach, lift, std::min(opening / pressing, left / 2.0), left);
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
struct RodFall {
    RodFall(MovingRod& falling, const PlateStep& plate_step, const Surface& plate_surface,
            const RodMoved& on_change)
        : rod(falling), step(plate_step), surface(plate_surface), moved(on_change), flight(falling) {
        if (!(calm && lies_still(rod, step)))
            return;
        rod.stop();
        left = 0.0;
        momentum.z() = rod.clump().mass * step.gravity * step.time_step;
        upward.push_back({1.0, momentum.z()});
    }

    /// Goes on to the next impact, whose impulse is then wanted; nullptr: the step is over.
    const ImpactCase* next_impact() {
        // two ends that rest push each other: an impulse leaves a quarter of the approach to the next round
        const int rounds = calm ? 12 : 1;
        for (;;) {
            while (contact < contacts)
                if (touches(contact++))
                    return &impact;
            if (++round >= rounds || bounces_before == bounces) {
                // To the next touch, if the step is not over.
                if (!(left > 0.0))
                    return nullptr;
                look();
                double next = never;
                for (std::size_t c = 0; c < contacts; ++c)
                    next = std::min(next, next_touch(approach(c), left, rest, lossless));
                if (!acted || bounces >= most_rod_bounces)
                    next = std::max(next, std::min(rest, left));
                rod.move(std::min(next, left), step.gravity);
                if (next == never)
                    return nullptr;
                left = std::max(left - next, 0.0);
                acted = false;
                look();
                round = 0;
            }
            bounces_before = bounces;
            contact = 0;
        }
    }

    /// The impulse of the impact.
    void push(const Vector3& impulse) {
        rod.push(impulse, arm);
        if (lift.z() != 0.0)
            rod.shift(lift);
        upward.emplace_back(side, impulse.z());
        flight = RodFlight(rod);
        momentum += impulse;
        acted = true;
        ++bounces;
        moved(rod);
    }

    RodApproach approach(std::size_t c) const {
        const std::size_t count = rod.outline().size(), sphere = rod.outline()[c % count];
        return {flight, plates[c / count], rod.clump().radius[sphere], rod.clump().offset[sphere]};
    }

    void look() {
        flight = RodFlight(rod);
        const double floor = step.floor.position(left), speed = step.floor.velocity(left);
        plates = {PlateNow{{1.0, &step}, left, floor, speed},
                  PlateNow{{-1.0, &step}, left, floor + step.gap, speed}};
    }

    /// Whether an impact is to be followed there: the sphere is in contact and approaches.
    bool touches(std::size_t c) {
        const RodApproach sphere = approach(c);
        const double gap = sphere.now().gap;
        if (!(gap <= touching * sphere.radius))
            return false;
        max_overlap = std::max(max_overlap, -gap / sphere.radius);
        side = sphere.plate_now.plate.side;
        const Vector3 normal(0.0, 0.0, side);
        arm = sphere.arm * rod.axis() - (sphere.radius + gap) * normal;
        const Vector3 relative = rod.velocity_at(arm) - Vector3(0.0, 0.0, sphere.plate_now.speed);
        const double speed = -relative.dot(normal);
        if (!(speed > 0.0))
            return false;
        const bool rests =
            !lossless && 2.0 * surface.restitution * speed < std::max(sphere.pressing(), step.gravity) * rest;
        lift = rests && gap < 0.0 ? Vector3(-gap * normal) : Vector3(Vector3::Zero());
        const Eigen::Matrix3d inverse_mass = rod.inverse_mass_at(arm);
        if (rests && step.still())
            if (const auto held = hold_or_slide(inverse_mass, relative, side, surface.friction)) {
                push(*held);
                return false;
            }
        frame = contact_frame(normal);
        impact =
            seen_in(frame, inverse_mass, relative, {surface.friction, rests ? 0.0 : surface.restitution});
        return true;
    }

    MovingRod& rod;
    const PlateStep& step;
    const Surface& surface;
    const RodMoved& moved;
    bool lossless = surface.restitution == 1.0;
    /// Where plates are still and contacts lose energy nothing but the rod's own fall disturbs those that
    /// rest.
    bool calm = step.still() && !lossless;
    double rest = (calm ? 1.0 : rest_share) * step.time_step;
    double left = step.time_step; ///< of the step
    RodFlight flight;
    std::array<PlateNow, 2> plates{};
    std::size_t contacts = 2 * rod.outline().size(); ///< its spheres at the floor, then at the lid
    std::size_t contact = contacts;                  ///< the next one of this round
    int round = 0, bounces = 0, bounces_before = 0;
    bool acted = true; ///< the last look gave an impulse; else time must pass
    ImpactCase impact;
    Eigen::Matrix3d frame; ///< of the impact
    Vector3 arm, lift;
    double side = 1.0;
    Vector3 momentum = Vector3::Zero();
    std::vector<std::pair<double, double>> upward; ///< side and impulse of each bounce
    double max_overlap = 0.0;
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
            falls[flying[k]].push(product(falls[flying[k]].frame, impacts[k].impulse));
    }
    for (std::size_t i = 0; i < rods.size(); ++i) {
        for (const auto& [side, impulse] : falls[i].upward)
            Plate{side, &step}.impulse(tally) += impulse;
        tally.impulses += falls[i].bounces;
        momentum[i] += falls[i].momentum;
        if (falls[i].max_overlap > tally.max_overlap) {
            tally.max_overlap = falls[i].max_overlap;
            tally.deepest = i;
        }
    }
}

} // namespace rodwake::granular
