#include "rod_bounces.hpp"

#include "bodies.hpp"
#include "touch_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rodwake::granular {

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
        rod.lift(-plate.side * gap);
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
