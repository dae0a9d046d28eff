#include "rod_bounces.hpp"

#include "bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::granular {

namespace {

constexpr double rest_share = 1.0 / 8.0; // of a step, between two impulses on a contact that rests
constexpr double touching = 1e-7;        // of a radius: nearer than that is in contact
constexpr int most_bounces = 1000;       // within one step; later ones do not rebound

/// Distance between a sphere of a freely flying rod and a plate as time goes on.
class Approach {
public:
    Approach(const MovingRod& rod, std::size_t sphere, const Plate& plate, double left)
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
        const double phase = rate_ * time,
                     rise = kept_ + swinging_ * std::cos(phase) + crossing_ * std::sin(phase);
        const double height = z_ + vz_ * time - plate_.step->gravity * time * time / 2.0 + arm_ * rise;
        return plate_.side * (height - plate_.height(left_ - time)) - radius_;
    }
    /// d gap/dt.
    double opening(double time) const {
        const double phase = rate_ * time,
                     rise = rate_ * (crossing_ * std::cos(phase) - swinging_ * std::sin(phase));
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

/// The root of gap + lift between a time outside and one inside the plate: Newton, kept between them.
double touch_between(const Approach& approach, double lift, double apart, double within) {
    double time = (apart + within) / 2.0;
    for (int i = 0; i < 60; ++i) {
        const double gap = approach.gap(time) + lift;
        (gap > 0.0 ? apart : within) = time;
        const double next = time - gap / approach.opening(time);
        const bool inside = (next >= apart && next <= within);
        const double taken = inside ? next : (apart + within) / 2.0;
        if (std::abs(taken - time) <= 1e-15 * within)
            return taken;
        time = taken;
    }
    return time;
}

constexpr double never = std::numeric_limits<double>::infinity();

/// When the sphere touches the plate next within `left`; a contact that rests is looked at again after
/// `rest`.
double next_touch(const Approach& approach, double left, double rest, bool lossless) {
    const double gap = approach.gap(0.0), opening = approach.opening(0.0), pressing = approach.pressing();
    // gap >= this for all times that count; rotation and plates change the acceleration little within a step
    if (gap + std::min(opening, 0.0) * left - std::max(pressing, 0.0) * left * left >
        touching * approach.radius())
        return never;
    const bool in_contact = gap <= touching * approach.radius();
    const double lift = in_contact ? std::max(-gap, 0.0) : 0.0;
    const double slowest = std::max(pressing, approach.gravity()) * rest; // what falling for `rest` adds
    const bool rests = lossless ? opening == 0.0 : -slowest <= opening && 2.0 * opening <= slowest;
    if (in_contact && rests)
        return std::min(rest, left);
    if (in_contact && opening <= 0.0)
        return 0.0;
    double clear = 0.0, inside = left;
    if (in_contact) { // on its way out: back after the top of its hop, if at all
        if (!(pressing > 0.0))
            return never;
        clear = std::min(opening / pressing, left / 2.0);
        if (approach.gap(left) + lift >= 0.0)
            return never;
    } else if (approach.gap(left) >= 0.0) { // it may graze on the way
        const double nearest = pressing < 0.0 ? opening / pressing : never;
        if (!(nearest < left) || approach.gap(nearest) >= 0.0)
            return never;
        inside = nearest;
    }
    return touch_between(approach, lift, clear, inside);
}

Plate plate_at(const PlateStep& step, int side) { return {side == 0 ? 1.0 : -1.0, &step}; }

/// One impulse where the sphere touches, if it is in contact and approaches; whether it was.
bool bounce(MovingRod& rod, std::size_t sphere, const Plate& plate, double left, double rest,
            const Surface& surface, PlateTally& tally) {
    const Approach now(rod, sphere, plate, left);
    const double gap = now.gap(0.0);
    if (!(gap <= touching * now.radius()))
        return false;
    tally.max_overlap = std::max(tally.max_overlap, -gap / now.radius());
    const Vector3 normal(0.0, 0.0, plate.side);
    const Vector3 arm = rod.clump().offset[sphere] * rod.axis() - (now.radius() + gap) * normal;
    const Vector3 relative = rod.velocity_at(arm) - Vector3(0.0, 0.0, plate.speed(left));
    const double approach = -relative.dot(normal);
    if (!(approach > 0.0))
        return false;
    const bool lossless = surface.restitution == 1.0;
    const bool rests = !lossless && 2.0 * surface.restitution * approach <
                                        std::max(now.pressing(), plate.step->gravity) * rest;
    const Surface acting{surface.friction, rests ? 0.0 : surface.restitution};
    const Vector3 impulse = impulse_along(normal, rod.inverse_mass_at(arm), relative, acting);
    rod.push(impulse, arm);
    if (rests && gap < 0.0)
        rod.lift(-plate.side * gap);
    plate.impulse(tally) += impulse.z();
    ++tally.impulses;
    return true;
}

} // namespace

void fly_rod(MovingRod& rod, const PlateStep& step, const Surface& surface, PlateTally& tally,
             const std::function<void()>& moved) {
    const bool lossless = surface.restitution == 1.0;
    const double rest = rest_share * step.time_step;
    double left = step.time_step;
    bool acted = true; // the last look gave an impulse; else time must pass
    for (int bounces = 0; left > 0.0;) {
        double next = never;
        for (const int side : {0, 1})
            for (const std::size_t sphere : rod.outline())
                next = std::min(next, next_touch(Approach(rod, sphere, plate_at(step, side), left), left,
                                                 rest, lossless));
        if (!acted || bounces >= most_bounces)
            next = std::max(next, std::min(rest, left));
        rod.move(std::min(next, left), step.gravity);
        if (next == never)
            return;
        left = std::max(left - next, 0.0);
        acted = false;
        for (const int side : {0, 1})
            for (const std::size_t sphere : rod.outline())
                if (bounce(rod, sphere, plate_at(step, side), left, rest, surface, tally)) {
                    acted = true;
                    ++bounces;
                    moved();
                }
    }
}

} // namespace rodwake::granular
