#pragma once
// Beads and rods against the wall of a container.
//
// A sphere of radius r touches the wall where its centre is r away from it in the plane; it does so along a
// straight line that is known from where it is and how it moves, so the instant follows in closed form. The
// impulse acts there and then, and the body flies on for the rest of the step, as it does off plates and
// other bodies (bounces.hpp, pair_contacts.hpp). All walls are convex rooms: no body can pass.

#include "bodies.hpp"
#include "kernels.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace rodwake::granular {

/// The point of the wall that a sphere is nearest to.
struct WallPoint {
    double depth;           ///< how far the sphere is through the wall, m; negative: the gap to it
    Eigen::Vector2d normal; ///< outwards
};

WallPoint nearest_wall(const Container& container, const Eigen::Vector2d& centre, double radius);

/// The same place, or the nearest at which a sphere is inside.
Eigen::Vector2d put_inside(const Container& container, const Eigen::Vector2d& centre, double radius);

/// What the wall did in one step.
struct WallTally {
    double impulse = 0.0; ///< towards the inside, N s
    std::int64_t beads = 0, rods = 0;
    double worst = 0.0;      ///< how deep a body was when the step began, in radii of its sphere
    std::size_t deepest = 0; ///< that sphere
    double shift = 0.0;      ///< the furthest that a body was put back, m
};

class Wall {
public:
    Wall(const Container& container, double time_step, double gravity)
        : container_(container), time_step_(time_step), gravity_(gravity) {}

    /// Of all bodies that flew through the wall in this step. `fastest`: no body moved faster in it;
    /// `shifted`: nor was moved further, impulses aside, since the step before. Beads that are not near the
    /// wall are not looked at. Velocities that the beads get are added to `velocities`. Beads that others
    /// pushed deep into the wall are moved out of it a little, but not while a bed settles.
    WallTally act(Bodies& bodies, double fastest, BodyRange& velocities, double shifted = 0.0,
                  bool settles = false);

private:
    void bead(Bodies& bodies, std::size_t bead, BodyRange& velocities, WallTally& tally) const;
    void rod(Bodies& bodies, std::size_t index, WallTally& tally) const;

    Container container_;
    double time_step_, gravity_;
    std::vector<std::uint32_t> near_; ///< beads less than the skin away from the wall when they were found
    double moved_ = std::numeric_limits<double>::infinity(); ///< no bead moved further since, m
    double fastest_ = 0.0;                                   ///< of the step before
    double largest_bead_ = 0.0;                              ///< no bead has a larger radius, m
};

} // namespace rodwake::granular
