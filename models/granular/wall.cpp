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

/// The point of this wall that a sphere is nearest to; a circle has one wall only.
WallPoint point_of(const Container& c, const Vector2d& normal, const Vector2d& centre, double radius) {
    if (c.kind == ContainerKind::circle)
        return nearest_wall(c, centre, radius);
    const Vector2d half(0.5 * c.sides.x, 0.5 * c.sides.y);
    return {(centre - middle(c)).dot(normal) - half.dot(normal.cwiseAbs()) + radius, normal};
}

/// A sphere that is through a wall now and goes on: how long ago it passed it, how deep it is.
struct WallTouch {
    double back; ///< s; infinite: it never did
    WallPoint now;
    double allowed; ///< how deep it was at the start, m: from there on the wall acts
};

/// The first wall that it passed.
std::optional<WallTouch> touch_of(const Container& c, const Vector2d& start, const Vector2d& centre,
                                  const Vector2d& v, double radius) {
    std::optional<WallTouch> first;
    const auto consider = [&](const WallPoint& now) {
        const double leaving = v.dot(now.normal);
        if (!(now.depth > 0.0 && leaving > 0.0))
            return;
        const double allowed = std::clamp(point_of(c, now.normal, start, radius).depth, 0.0, now.depth);
        double back = (now.depth - allowed) / leaving;
        if (c.kind == ContainerKind::circle) {
            const Vector2d r = centre - middle(c);
            const double reach = c.radius() - radius + allowed, distance = r.norm(),
                         excess = (distance - reach) * (distance + reach), along = r.dot(v),
                         square = along * along - v.squaredNorm() * excess;
            back = square >= 0.0 ? excess / (along + std::sqrt(square))
                                 : std::numeric_limits<double>::infinity();
        }
        if (!first || back > first->back)
            first = {back, now, allowed};
    };
    if (c.kind == ContainerKind::circle) {
        consider(nearest_wall(c, centre, radius));
    } else {
        const Vector2d r = centre - middle(c);
        consider(point_of(c, {std::copysign(1.0, r.x()), 0.0}, centre, radius));
        consider(point_of(c, {0.0, std::copysign(1.0, r.y())}, centre, radius));
    }
    return first;
}

/// On a bead whose centre is there, from the wall behind `outwards`.
void push_bead_from_wall(Bodies& bodies, std::size_t bead, const Vector2d& outwards, const Surface& surface,
                         WallTally& tally) {
    auto v = row(bodies.velocity, bead);
    auto w = row(bodies.spin, bead);
    const double radius = bodies.radius_of_bead(bead), inertia = bodies.inertia_of_bead(bead);
    const Vector3 inwards(-outwards.x(), -outwards.y(), 0.0), arm = -radius * inwards;
    const Vector3 relative = v + w.cross(arm);
    const double per_mass = 1.0 / bodies.mass_of_bead(bead), k_t = per_mass + radius * radius / inertia;
    const double approach = v.dot(inwards);
    if (!(approach < 0.0))
        return;
    const Vector3 impulse = uncoupled_along(inwards, relative, approach, k_t, per_mass, surface);
    v += per_mass * impulse;
    w += arm.cross(impulse) / inertia;
    tally.impulse += impulse.dot(inwards);
    ++tally.beads;
}

void note_wall_depth(WallTally& tally, double radii, std::size_t sphere) {
    if (radii > tally.worst) {
        tally.worst = radii;
        tally.deepest = sphere;
    }
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

WallTally Wall::act(Bodies& bodies, double fastest, BodyRange& velocities, double shifted, bool settles) {
    moved_ += (2.0 * fastest + fastest_) * time_step_ + shifted; // by its flight, and by the impulse before
    fastest_ = fastest;
    if (!(moved_ < skin * bodies.bead_radius)) {
        near_.clear();
        largest_bead_ = bodies.bead_radius;
        for (std::size_t i = 0; i < bodies.beads && !bodies.equal_beads; ++i)
            largest_bead_ = std::max(largest_bead_, bodies.radius[i]);
        const double limit = -skin * bodies.bead_radius;
        for (std::size_t i = 0; i < bodies.beads; ++i)
            if (!(nearest_wall(container_, row(bodies.position, i).head<2>(), bodies.radius_of_bead(i))
                      .depth < limit))
                near_.push_back(static_cast<std::uint32_t>(i));
        moved_ = 0.0;
    }
    WallTally tally;
    for (const std::uint32_t i : near_)
        bead(bodies, i, velocities, tally);
    if (tally.worst > deep && !settles) {
        for (const std::uint32_t i : near_) {
            const double a = bodies.radius_of_bead(i);
            auto centre = row(bodies.position, i).head<2>();
            const WallPoint at = nearest_wall(container_, centre, a);
            if (at.depth > deep * a)
                centre -= std::min(at.depth - deep * a, most_moved * a) * at.normal;
        }
        tally.shift = most_moved * largest_bead_;
    }
    for (std::size_t i = 0; i < bodies.rods.size(); ++i)
        rod(bodies, i, tally);
    return tally;
}

void Wall::bead(Bodies& bodies, std::size_t bead, BodyRange& velocities, WallTally& tally) const {
    auto position = row(bodies.position, bead);
    auto v = row(bodies.velocity, bead);
    const Surface& surface = container_.beads;
    const Surface dead{surface.friction, 0.0};
    const double a = bodies.radius_of_bead(bead);
    const Vector2d start = (position - time_step_ * v).head<2>();
    double left = time_step_;
    bool slides = false;
    int settled = 0;
    for (int bounces = 0;; ++bounces) {
        const auto touch = touch_of(container_, start, position.head<2>(), v.head<2>(), a);
        if (!touch)
            return;
        // What pushed it in before the step, it leaves by itself: it may not get deeper.
        note_wall_depth(tally, touch->allowed / a, bead);
        const WallPoint& now = touch->now;
        if (slides || bounces >= most_in_a_step) {
            push_bead_from_wall(bodies, bead, now.normal, surface.restitution < 1.0 ? dead : surface, tally);
            position.head<2>() -= (now.depth - touch->allowed) * now.normal;
            velocities.include(&bodies.velocity[4 * bead]);
            if (++settled == 2) // walls of a corner
                return;
            continue;
        }
        left = std::min(touch->back, left);
        position -= left * v;
        const Vector2d normal = point_of(container_, now.normal, position.head<2>(), a).normal;
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
        // Find the first to touch the wall among the spheres that are through it and go on.
        std::optional<WallTouch> first;
        std::size_t sphere = 0;
        for (const std::size_t k : rod.outline()) {
            const Vector2d v = rod.velocity_at(clump.offset[k] * rod.axis()).head<2>();
            auto touch =
                touch_of(container_, middle(container_), rod.centre(k).head<2>(), v, clump.radius[k]);
            if (!touch)
                continue;
            touch->back = std::min(touch->back, left);
            if (!first || touch->back > first->back ||
                (touch->back == first->back && touch->now.depth > first->now.depth)) {
                first = touch;
                sphere = k;
            }
        }
        if (!first)
            break;
        left = first->back;
        rod.move(-left, gravity_);
        const double radius = clump.radius[sphere];
        const WallPoint at = point_of(container_, first->now.normal, rod.centre(sphere).head<2>(), radius);
        const Vector3 inwards(-at.normal.x(), -at.normal.y(), 0.0),
            arm = clump.offset[sphere] * rod.axis() - (radius - at.depth) * inwards;
        const Vector3 relative = rod.velocity_at(arm);
        if (relative.dot(inwards) < 0.0) {
            const Vector3 impulse =
                impulse_along(inwards, rod.inverse_mass_at(arm), relative, container_.rods);
            rod.push(impulse, arm);
            tally.impulse += impulse.dot(inwards);
            ++tally.rods;
        }
        if (at.depth > 0.0) { // it was in the wall before; without this it would creep along a curved one
            note_wall_depth(tally, at.depth / radius, bodies.first_sphere[index] + sphere);
            rod.shift(at.depth * inwards);
            tally.shift = std::max(tally.shift, at.depth);
        }
        rod.move(left, gravity_);
        bodies.place_rod_spheres(index);
    }
}

} // namespace rodwake::granular
