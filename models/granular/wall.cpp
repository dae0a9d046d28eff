#include "wall.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rodwake::granular {

namespace {

using Eigen::Vector2d;

constexpr double skin = 1.0;       // of a bead's radius
constexpr int most_in_a_step = 16; // bounces of a bead; then it turns round, or stays, at the wall
constexpr int most_of_rod = 8;     // impulses on a rod within one step
constexpr double short_hop = 0.05; // of a step: shorter hops along a curved wall add up to sliding

Vector2d middle(const Container& c) { return {0.5 * c.sides.x, 0.5 * c.sides.y}; }

/// How long ago a sphere that is through the wall now passed the line `allowed` behind it; infinite: never.
double since_touch(const Container& c, const Vector2d& centre, const Vector2d& v, double radius,
                   double allowed, const WallPoint& now) {
    if (c.kind == ContainerKind::rectangle)
        return (now.depth - allowed) / v.dot(now.normal);
    const Vector2d r = centre - middle(c);
    const double reach = c.radius() - radius + allowed, distance = r.norm(),
                 excess = (distance - reach) * (distance + reach), along = r.dot(v),
                 square = along * along - v.squaredNorm() * excess;
    return square >= 0.0 ? excess / (along + std::sqrt(square)) : std::numeric_limits<double>::infinity();
}

/// On a bead whose centre is there, from the wall behind `outwards`.
void push_bead_from_wall(Bodies& bodies, std::size_t bead, const Vector2d& outwards, const Surface& surface,
                         WallTally& tally) {
    auto v = row(bodies.velocity, bead);
    auto w = row(bodies.spin, bead);
    const Vector3 inwards(-outwards.x(), -outwards.y(), 0.0), arm = -bodies.bead_radius * inwards;
    const Vector3 relative = v + w.cross(arm);
    const double per_mass = 1.0 / bodies.bead_mass,
                 k_t = per_mass + bodies.bead_radius * bodies.bead_radius / bodies.bead_inertia;
    const double approach = v.dot(inwards);
    if (!(approach < 0.0))
        return;
    const Vector3 impulse = uncoupled_along(inwards, relative, approach, k_t, per_mass, surface);
    v += per_mass * impulse;
    w += arm.cross(impulse) / bodies.bead_inertia;
    tally.impulse += impulse.dot(inwards);
    ++tally.beads;
}

void note_wall_depth(WallTally& tally, double radii, std::size_t sphere) {
    if (radii > tally.worst) {
        tally.worst = radii;
        tally.deepest = sphere;
    }
}

/// Of the spheres of a rod that are through the wall and go on, the first to touch it.
struct RodTouch {
    std::size_t sphere;
    double back, depth; ///< s, not before the time that counts; m
};

std::optional<RodTouch> first_touch_of_wall(const Container& container, const MovingRod& rod, double left) {
    std::optional<RodTouch> first;
    const Clump& clump = rod.clump();
    for (const std::size_t k : rod.outline()) {
        const Vector2d centre = rod.centre(k).head<2>(),
                       v = rod.velocity_at(clump.offset[k] * rod.axis()).head<2>();
        const WallPoint at = nearest_wall(container, centre, clump.radius[k]);
        if (!(at.depth > 0.0 && v.dot(at.normal) > 0.0))
            continue;
        const double back = std::min(since_touch(container, centre, v, clump.radius[k], 0.0, at), left);
        if (!first || back > first->back || (back == first->back && at.depth > first->depth))
            first = {k, back, at.depth};
    }
    return first;
}

} // namespace

double Container::area() const {
    return kind == ContainerKind::circle ? M_PI * radius() * radius() : sides.area();
}

WallPoint nearest_wall(const Container& container, const Vector2d& centre, double radius) {
    const Vector2d r = centre - middle(container);
    if (container.kind == ContainerKind::circle) {
        const double distance = r.norm();
        return {distance - (container.radius() - radius),
                distance > 0.0 ? Vector2d(r / distance) : Vector2d(Vector2d::UnitX())};
    }
    const double x = std::abs(r.x()) - (0.5 * container.sides.x - radius),
                 y = std::abs(r.y()) - (0.5 * container.sides.y - radius);
    return x > y ? WallPoint{x, {std::copysign(1.0, r.x()), 0.0}}
                 : WallPoint{y, {0.0, std::copysign(1.0, r.y())}};
}

Vector2d put_inside(const Container& container, const Vector2d& centre, double radius) {
    Vector2d inside = centre;
    for (int side = 0; side < 2; ++side) // of a rectangle both may be passed
        if (const WallPoint at = nearest_wall(container, inside, radius); at.depth > 0.0)
            inside -= at.depth * at.normal;
    return inside;
}

void Wall::find_near(const Bodies& bodies) {
    near_.clear();
    const double limit = -skin * bodies.bead_radius;
    for (std::size_t i = 0; i < bodies.beads; ++i)
        if (!(nearest_wall(container_, row(bodies.position, i).head<2>(), bodies.bead_radius).depth < limit))
            near_.push_back(static_cast<std::uint32_t>(i));
    moved_ = 0.0;
}

WallTally Wall::act(Bodies& bodies, double fastest, Range& velocities) {
    moved_ += (2.0 * fastest + fastest_) * time_step_; // by its flight, and by the impulse before
    fastest_ = fastest;
    if (!(moved_ < skin * bodies.bead_radius))
        find_near(bodies);
    WallTally tally;
    for (const std::uint32_t i : near_)
        bead(bodies, i, velocities, tally);
    for (std::size_t i = 0; i < bodies.rods.size(); ++i)
        rod(bodies, i, tally);
    return tally;
}

void Wall::bead(Bodies& bodies, std::size_t bead, Range& velocities, WallTally& tally) const {
    auto position = row(bodies.position, bead);
    auto v = row(bodies.velocity, bead);
    const Surface& surface = container_.beads;
    const Surface dead{surface.friction, 0.0};
    const double a = bodies.bead_radius;
    double left = time_step_, allowed = 0.0;
    bool slides = false;
    for (int bounces = 0;; ++bounces) {
        const WallPoint at = nearest_wall(container_, position.head<2>(), a);
        if (!(at.depth > 0.0 && v.head<2>().dot(at.normal) > 0.0))
            return;
        // What pushed it in before the step, it leaves by itself: it may not get deeper.
        if (bounces == 0) {
            const Vector2d before = (position - left * v).head<2>();
            allowed = std::clamp(nearest_wall(container_, before, a).depth, 0.0, at.depth);
            note_wall_depth(tally, allowed / a, bead);
        }
        if (slides || bounces == most_in_a_step) {
            push_bead_from_wall(bodies, bead, at.normal, surface.restitution < 1.0 ? dead : surface, tally);
            position.head<2>() -= std::max(at.depth - allowed, 0.0) * at.normal;
            velocities.include(&bodies.velocity[4 * bead]);
            return;
        }
        left = std::min(since_touch(container_, position.head<2>(), v.head<2>(), a, allowed, at), left);
        position -= left * v;
        const Vector2d normal = nearest_wall(container_, position.head<2>(), a).normal;
        const double towards = v.head<2>().dot(normal),
                     along2 = v.head<2>().squaredNorm() - towards * towards,
                     pressing = container_.kind == ContainerKind::circle ? along2 / container_.radius() : 0.0;
        slides = surface.restitution < 1.0 &&
                 2.0 * surface.restitution * towards < pressing * short_hop * time_step_;
        v.z() += gravity_ * left;
        push_bead_from_wall(bodies, bead, normal, slides ? dead : surface, tally);
        v.z() -= gravity_ * left;
        position += left * v; // where gravity took it stays
        velocities.include(&bodies.velocity[4 * bead]);
    }
}

void Wall::rod(Bodies& bodies, std::size_t index, WallTally& tally) const {
    MovingRod& rod = bodies.rods[index];
    const Clump& clump = rod.clump();
    if (rod.held() || nearest_wall(container_, rod.body().position.head<2>(), clump.reach()).depth < 0.0)
        return;
    double left = time_step_;
    for (int impulses = 0; impulses < most_of_rod; ++impulses) {
        const auto touch = first_touch_of_wall(container_, rod, left);
        if (!touch)
            break;
        left = touch->back;
        rod.move(-left, gravity_);
        const double radius = clump.radius[touch->sphere];
        const WallPoint at = nearest_wall(container_, rod.centre(touch->sphere).head<2>(), radius);
        const Vector3 inwards(-at.normal.x(), -at.normal.y(), 0.0),
            arm = clump.offset[touch->sphere] * rod.axis() - (radius - at.depth) * inwards;
        const Vector3 relative = rod.velocity_at(arm);
        if (relative.dot(inwards) < 0.0) {
            const Vector3 impulse =
                impulse_along(inwards, rod.inverse_mass_at(arm), relative, container_.rods);
            rod.push(impulse, arm);
            tally.impulse += impulse.dot(inwards);
            ++tally.rods;
        }
        if (at.depth > 0.0) { // it was in the wall before; without this it would creep along a curved one
            note_wall_depth(tally, at.depth / radius, bodies.first_sphere[index] + touch->sphere);
            rod.shift(at.depth * inwards);
            tally.shift = std::max(tally.shift, at.depth);
        }
        rod.move(left, gravity_);
        bodies.place_rod_spheres(index);
    }
}

} // namespace rodwake::granular
