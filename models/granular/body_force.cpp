#include "rodwake/granular/body_force.hpp"

#include "bodies.hpp"
#include "fixed_order.hpp"

#include <algorithm>

namespace rodwake::granular {

namespace {

constexpr double nothing = 37.0; // exp(-37) is below a rounding of the peak

/// The force at one time: what all beads share.
struct Push {
    const BodyForce& force;
    PeriodicBox box;
    double x = 0.0, y = 0.0, per_square = 0.0; ///< R(t); 1/(2 width^2)

    Push(const BodyForce& f, double time, const PeriodicBox& sides) : force(f), box(sides) {
        if (f.kind == BodyForceKind::uniform)
            return;
        const bool given = f.place.size() == 2;
        const Eigen::Vector2d way = direction(f.direction);
        x = (given ? f.place[0] : 0.5 * box.x) + f.speed * time * way.x();
        y = (given ? f.place[1] : 0.5 * box.y) + f.speed * time * way.y();
        per_square = 1.0 / (2.0 * f.width * f.width);
    }
    double at(double bead_x, double bead_y) const {
        if (force.kind == BodyForceKind::uniform)
            return force.acceleration;
        const double dx = nearest_image_rounded(bead_x - x, box.x),
                     dy = nearest_image_rounded(bead_y - y, box.y),
                     exponent = (dx * dx + dy * dy) * per_square;
        return exponent < nothing ? force.acceleration * repeatable::exp(-exponent) : 0.0;
    }
};

} // namespace

double BodyForce::at(double place_x, double place_y, double time, const PeriodicBox& box) const {
    return Push(*this, time, box).at(place_x, place_y);
}

void kick(Bodies& bodies, const BodyForce& force, const PeriodicBox& box, double time, double duration,
          ThreadPool& team) {
    const Push push(force, time, box);
    const Eigen::Vector2d way = duration * direction(force.direction);
    team.run((bodies.beads + beads_per_block - 1) / beads_per_block, [&](std::size_t block) {
        const std::size_t end = std::min(bodies.beads, (block + 1) * beads_per_block);
        for (std::size_t i = block * beads_per_block; i < end; ++i) {
            const double b = push.at(bodies.position[4 * i], bodies.position[4 * i + 1]);
            bodies.velocity[4 * i] += b * way.x();
            bodies.velocity[4 * i + 1] += b * way.y();
        }
    });
}

} // namespace rodwake::granular
