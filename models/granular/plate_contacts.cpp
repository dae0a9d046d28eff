#include "plate_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::granular {

PlateMotion::PlateMotion(const Plates& plates, double gravity)
    : amplitude_(plates.amplitude(gravity)), omega_(2.0 * std::numbers::pi * plates.frequency),
      gap_(plates.gap) {}

PlatePath PlateMotion::floor(double time) const {
    const double c = amplitude_ * std::cos(omega_ * time), s = amplitude_ * std::sin(omega_ * time),
                 w = omega_;
    // cos(w t - w b) = cos wt cos wb + sin wt sin wb
    return PlatePath({c, s * w, -c * w * w / 2.0, -s * w * w * w / 6.0, c * w * w * w * w / 24.0,
                      s * w * w * w * w * w / 120.0, -c * w * w * w * w * w * w / 720.0,
                      -s * w * w * w * w * w * w * w / 5040.0});
}

namespace {

/// One plate seen from the particles: side +1 the floor (normal up), -1 the lid (normal down).
struct Plate {
    double side;
    const PlateStep* step;

    double height(double before) const {
        return step->floor.position(before) + (side > 0.0 ? 0.0 : step->gap);
    }
    double height_now() const { return step->floor.position() + (side > 0.0 ? 0.0 : step->gap); }
    double speed(double before) const { return step->floor.velocity(before); }
    double speed_now() const { return step->floor.velocity(); }
    /// Acceleration with which a free body is pressed against it; negative where the plate runs away.
    double pressing() const { return side * (step->gravity + step->floor.acceleration()); }
    double& impulse(PlateTally& tally) const { return side > 0.0 ? tally.floor_impulse : tally.lid_impulse; }
};

constexpr int most_bounces = 16;      // within one step; more come to rest
constexpr double shortest_hop = 0.05; // of a step

/// A bead at the end of the step and the time it may go back.
struct Flight {
    double z, vz, radius, back;

    double gap(const Plate& plate, double before) const {
        const double height = z - vz * before - plate.step->gravity * before * before / 2.0;
        return plate.side * (height - plate.height(before)) - radius;
    }
    double gap_now(const Plate& plate) const { return plate.side * (z - plate.height_now()) - radius; }
    double opening_now(const Plate& plate) const { return plate.side * (vz - plate.speed_now()); }
    /// d gap/dt at that time: negative when approaching.
    double opening(const Plate& plate, double before) const {
        return plate.side * (vz + plate.step->gravity * before - plate.speed(before));
    }
};

/// The same with constant accelerations; off by about 1e-4 steps. Outside the step where there is no such
/// time.
double rough_time_since_touch(double depth, double approach, double pressing) {
    const double inside = approach * approach - 2.0 * pressing * depth;
    return inside >= 0.0 ? 2.0 * depth / (approach + std::sqrt(inside)) : -1.0;
}

/// The last time the bead was clear of the plate: the start of its flight, or the top of its hop if it leaves
/// the plate there.
double last_clear(const Flight& flight, const Plate& plate) {
    const double leaving = flight.opening(plate, flight.back);
    if (!(leaving > 0.0 && plate.pressing() > 0.0))
        return flight.back;
    return std::max(flight.back - leaving / plate.pressing(), flight.back / 2.0);
}

/// How long before the end of the step the bead touched the plate: Newton, kept between bounds.
double time_since_touch(const Flight& flight, const Plate& plate) {
    // Touching from the start on, or so soon that it makes no hop.
    const double soon = shortest_hop * flight.back, hop = std::max(plate.pressing(), 0.0) * soon * soon / 2.0;
    if (flight.gap(plate, flight.back) <= hop &&
        std::abs(flight.opening(plate, flight.back)) <= plate.pressing() * soon)
        return flight.back;
    double apart = last_clear(flight, plate), within = 0.0;
    double before =
        rough_time_since_touch(-flight.gap_now(plate), -flight.opening_now(plate), plate.pressing());
    if (!(before > within && before < apart))
        before = (within + apart) / 2.0;
    for (int i = 0; i < 60; ++i) {
        const double gap = flight.gap(plate, before);
        (gap > 0.0 ? apart : within) = before;
        const double next = before + gap / flight.opening(plate, before); // d gap/d before = -opening
        const double taken = next >= within && next <= apart ? next : (within + apart) / 2.0;
        if (std::abs(taken - before) <=
            1e-8 * flight.back) // Newton doubles the digits: what is left is rounding
            return taken;
        before = taken;
    }
    return before;
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

void rest_bead(Bodies& bodies, std::size_t bead, const Plate& plate, const Surface& surface,
               PlateTally& tally) {
    push_bead(bodies, bead, plate, plate.speed_now(), {surface.friction, 0.0}, tally);
    bodies.position[4 * bead + 2] = plate.height_now() + plate.side * bodies.bead_radius;
}

/// Bounces at the touch `before` the end of the step and flies on to the end.
void bounce_at(Bodies& bodies, std::size_t bead, const Plate& plate, double before, const Surface& surface,
               PlateTally& tally) {
    auto x = row(bodies.position, bead);
    auto v = row(bodies.velocity, bead);
    const double gravity = plate.step->gravity;
    const Vector3 old = v;
    v.z() += gravity * before;
    push_bead(bodies, bead, plate, plate.speed(before), surface, tally);
    x.x() += (v.x() - old.x()) * before;
    x.y() += (v.y() - old.y()) * before;
    x.z() = plate.height(before) + plate.side * bodies.bead_radius + v.z() * before -
            gravity * before * before / 2.0;
    v.z() -= gravity * before;
}

/// Whether a bead that touches with this speed hops for less than that: such hops add up to a rest on the
/// plate.
bool comes_to_rest(double touching_speed, const Plate& plate, double restitution) {
    return 2.0 * restitution * touching_speed < plate.pressing() * shortest_hop * plate.step->time_step;
}

/// The plate that the bead is in, or none (nullptr): the gap is wider than a bead.
const Plate* entered(const Flight& flight, const Plate& floor, const Plate& lid) {
    return flight.gap_now(floor) < 0.0 ? &floor : flight.gap_now(lid) < 0.0 ? &lid : nullptr;
}

struct Deepest {
    std::size_t sphere;
    double depth;
};

Deepest deepest_sphere(const MovingRod& rod, const Plate& plate) {
    const Clump& clump = rod.clump();
    const double height = plate.height_now(), rise = rod.axis().z();
    Deepest deepest{0, -std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < clump.radius.size(); ++k) {
        const double z = rod.body().position.z() + clump.offset[k] * rise;
        const double depth = clump.radius[k] - plate.side * (z - height);
        if (depth > deepest.depth)
            deepest = {k, depth};
    }
    return deepest;
}

void bounce_rod_off(MovingRod& rod, const Plate& plate, const Surface& surface, PlateTally& tally) {
    const Deepest contact = deepest_sphere(rod, plate);
    if (!(contact.depth > 0.0))
        return;
    const double radius = rod.clump().radius[contact.sphere];
    tally.max_overlap = std::max(tally.max_overlap, contact.depth / radius);
    const Vector3 normal(0.0, 0.0, plate.side);
    const Vector3 arm = rod.clump().offset[contact.sphere] * rod.axis() - (radius - contact.depth) * normal;
    const Vector3 relative = rod.velocity_at(arm) - Vector3(0.0, 0.0, plate.speed_now());
    const double approach = -relative.dot(normal);
    if (!(approach > 0.0))
        return;
    const double rebound = surface.restitution * approach;
    // without losses nothing comes to rest: it would take or give energy
    const bool rests =
        surface.restitution < 1.0 && rebound * rebound < 2.0 * plate.pressing() * contact.depth;
    const Surface acting{surface.friction, rests ? 0.0 : surface.restitution};
    const Vector3 impulse = impulse_along(normal, rod.inverse_mass_at(arm), relative, acting);
    rod.push(impulse, arm);
    if (rests)
        rod.lift(plate.side * contact.depth);
    plate.impulse(tally) += impulse.z();
    ++tally.impulses;
}

} // namespace

void bounce_bead(Bodies& bodies, std::size_t bead, const PlateStep& step, const Surface& surface,
                 Range& velocities, PlateTally& tally) {
    const Plate floor{1.0, &step}, lid{-1.0, &step};
    double back = step.time_step;
    for (int bounces = 0;; ++bounces) {
        const Flight flight{bodies.position[4 * bead + 2], bodies.velocity[4 * bead + 2], bodies.bead_radius,
                            back};
        const Plate* plate = entered(flight, floor, lid);
        if (!plate)
            return;
        if (const double deep = -flight.gap_now(*plate) / bodies.bead_radius; deep > tally.deepest_flight) {
            tally.deepest_flight = deep;
            tally.deepest = bead;
        }
        back = time_since_touch(flight, *plate);
        const bool rests = bounces == most_bounces ||
                           comes_to_rest(-flight.opening(*plate, back), *plate, surface.restitution);
        rests ? rest_bead(bodies, bead, *plate, surface, tally)
              : bounce_at(bodies, bead, *plate, back, surface, tally);
        velocities.include(&bodies.velocity[4 * bead]);
        if (rests)
            return;
    }
}

void bounce_rod(MovingRod& rod, const PlateStep& step, const Surface& surface, PlateTally& tally) {
    bounce_rod_off(rod, {1.0, &step}, surface, tally);
    bounce_rod_off(rod, {-1.0, &step}, surface, tally);
}

} // namespace rodwake::granular
