#pragma once
// The moving bodies in the layout the step works on: four doubles a sphere (x, y, z and one more), so that
// one vector load brings a whole position. Measured against separate x, y, z arrays with gathers it halves
// the cost of the overlap test; the state that is stored and handed out is a structure of arrays (state.hpp).
//
// The fourth number of a position is the sphere's radius and that of a spin the bead's mass, so that an
// impact of beads of several sizes reads no memory that it does not read anyway. Loops over pairs and over
// all beads are compiled twice: beads that are all equal have their size in constants, not in rows.

#include "kernels.hpp"
#include "rod_motion.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/granular/impact.hpp"
#include "rodwake/granular/observe.hpp"
#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/state.hpp"

#include <hwy/cache_control.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace rodwake::granular {

/// Beads of successive numbers that are worked on together: one task.
inline constexpr std::size_t beads_per_block = 2048;

/// How many impulses before its own a bead is fetched from memory.
inline constexpr std::size_t fetched_ahead = 8;

/// Bodies that are deeper in each other or in a wall than `deep` radii are moved out by `most_moved` a step,
/// once a bed has settled: faster than those sink that do not rebound, slower than a jam deepens. Beds that
/// started from a lattice stay below it.
inline constexpr double deep = 0.05, most_moved = 1e-4;

struct Bodies {
    std::size_t beads = 0;
    bool equal_beads = true; ///< all have the following size; else that of a bead of radius a
    double bead_radius = 0.0, bead_mass = 0.0, bead_inertia = 0.0;

    Rows position; ///< [beads + rod spheres][4], unwrapped; the fourth: radius, m
    Rows velocity; ///< [beads][4]; the fourth: 0
    Rows spin;     ///< [beads][4]; the fourth: mass, kg
    std::vector<MovingRod> rods;
    std::vector<double> radius;     ///< [beads + rod spheres]
    std::vector<std::uint8_t> kind; ///< [beads]; empty: one
    std::size_t kinds = 1;
    bool stores_radii = false;             ///< its states hold the radii of the beads
    std::vector<std::uint32_t> rod_of;     ///< [rod spheres]
    std::vector<std::size_t> first_sphere; ///< [rods]

    std::size_t spheres() const { return radius.size(); }
    bool is_bead(std::size_t sphere) const { return sphere < beads; }
    /// The radius of a sphere, m; equal beads take no look into memory.
    template<bool equal>
    double radius_of(std::size_t sphere) const {
        if constexpr (equal)
            return is_bead(sphere) ? bead_radius : radius[sphere];
        else
            return position[4 * sphere + 3];
    }
    double radius_of_bead(std::size_t bead) const { return position[4 * bead + 3]; }
    double mass_of_bead(std::size_t bead) const { return spin[4 * bead + 3]; }
    double inertia_of_bead(std::size_t bead) const {
        const double a = radius_of_bead(bead);
        return 0.4 * mass_of_bead(bead) * a * a;
    }
    bool same_rod(std::size_t one, std::size_t two) const {
        return one >= beads && two >= beads && rod_of[one - beads] == rod_of[two - beads];
    }

    /// Puts the rods' sphere centres into `position`: of all, or of one.
    void place_rod_spheres();
    void place_rod_spheres(std::size_t rod);
    /// From the centre of its rod's mass to a rod's sphere, m.
    Vector3 arm_of(std::size_t sphere) const;
    /// Of a sphere's centre, m/s.
    Vector3 velocity_of(std::size_t sphere) const;
    /// Asks for what an impulse on a bead needs to be brought into the cache; rods are there. Inline, or GCC
    /// 12 takes it for a function without effect and leaves it out.
    HWY_INLINE void fetch(std::size_t sphere) const {
        if (!is_bead(sphere))
            return;
        for (const Rows* rows : {&position, &velocity, &spin})
            hwy::Prefetch(&(*rows)[4 * sphere]);
    }
};

Bodies make_bodies(const GranularProblem& problem, const State& state);
State to_state(const Bodies& bodies, std::int64_t step);

Agitation agitation_of(const Bodies& bodies);
Energy total_energy(const Bodies& bodies, double gravity);

/// A contact's axes in columns: two tangents and the normal.
Eigen::Matrix3d contact_frame(const Eigen::Vector3d& normal);
/// An impact, given in world axes, in those of its contact.
ImpactCase seen_in(const Eigen::Matrix3d& frame, const Eigen::Matrix3d& inverse_mass,
                   const Eigen::Vector3d& relative_velocity, const Surface& surface);

/// The impulse on body 1 of Stronge's law about `normal` (unit, from body 2 to body 1); everything in world
/// axes.
Eigen::Vector3d impulse_along(const Eigen::Vector3d& normal, const Eigen::Matrix3d& inverse_mass,
                              const Eigen::Vector3d& relative_velocity, const Surface& surface);

/// A contact that rests on a plate at rest follows no impact. It gets the impulse that stops the point if
/// friction can hold it, else one that ends its approach and acts against the slip as it is now; nothing if
/// that would give energy.
std::optional<Vector3> hold_or_slide(const Eigen::Matrix3d& inverse_mass, const Vector3& relative,
                                     double side, double friction);

/// impulse_along for spheres, on which the normal impulse does not turn the slip: of the slip the law needs
/// only the size. approach: normal part of the velocity.
inline Vector3 uncoupled_along(const Vector3& n, const Vector3& relative, double approach, double k_t,
                               double k_n, const Surface& surface) {
    const Vector3 slip = relative - approach * n;
    const double speed = slip.norm();
    const Vector3 p = uncoupled_impact(k_t, k_n, Vector3(speed, 0.0, approach), surface).impulse;
    return p.z() * n + (speed > 0.0 ? Vector3(p.x() / speed * slip) : Vector3(Vector3::Zero()));
}

// Kicks by a body force.

/// Beads get what the force of this time gives them over the duration, where they are. Each on its own: the
/// number of threads changes no bit.
void kick(Bodies& bodies, const BodyForce& force, const PeriodicBox& box, double time, double duration,
          ThreadPool& team);

} // namespace rodwake::granular
