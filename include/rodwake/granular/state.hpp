#pragma once
// The state of a granular run: everything that the next step depends on, and nothing else.

#include "rodwake/granular/shape.hpp"

#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rodwake::granular {

/// Structure of arrays. Positions are unwrapped: a bead that leaves the box keeps counting.
struct Beads {
    std::vector<double> x, y, z;    ///< m
    std::vector<double> vx, vy, vz; ///< m/s
    std::vector<double> wx, wy, wz; ///< angular velocity, rad/s
    std::vector<double> radius;     ///< m; empty: all are GranularProblem::bead_radius
    std::vector<std::uint8_t> kind; ///< number of the bead's kind; empty: there is one

    std::size_t size() const { return x.size(); }
    /// Places and motion, zero where new.
    void resize(std::size_t count);
    bool operator==(const Beads&) const = default;
};

struct RodBody {
    Eigen::Vector3d position = Eigen::Vector3d::Zero(); ///< centre of mass, unwrapped, m
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero(); ///< m/s
    Eigen::Quaterniond orientation =
        Eigen::Quaterniond::Identity();                         ///< body to world; the axis is the body's x
    Eigen::Vector3d angular_momentum = Eigen::Vector3d::Zero(); ///< world, kg m^2/s

    /// Unit vector from the thick to the thin end.
    Eigen::Vector3d axis() const { return orientation * Eigen::Vector3d::UnitX(); }
    /// Angle of the axis' projection on the floor from +x, rad, in (-pi, pi].
    double heading() const;
};

struct State {
    std::int64_t step = 0; ///< steps done since the start; time is step * dt, t = 0 after the equilibration
    Beads beads;
    std::vector<RodBody> rods;
};

/// Centres of all spheres, beads first and then rod by rod, x, y, z each; one clump a rod. m.
std::vector<double> sphere_positions(const State& state, std::span<const Clump> clumps);
/// Their velocities, m/s: the spin of a rod across its axis moves its spheres, that about it does not.
std::vector<double> sphere_velocities(const State& state, std::span<const Clump> clumps);

/// 64-bit XXH3 of every bit of the state. Radii count where they differ; kinds, which change no motion, do
/// not.
std::uint64_t state_hash(const State& state);

/// Of the hashes of several runs, in this order.
std::uint64_t combined_hash(const std::vector<std::uint64_t>& hashes);

} // namespace rodwake::granular
