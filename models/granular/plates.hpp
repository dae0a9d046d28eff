#pragma once
// Where the plates are: floor z = A cos(2 pi f t), lid the same + gap.

#include "rodwake/granular/problem.hpp"

#include <array>

namespace rodwake::granular {

/// Height of the floor near one instant as a Taylor polynomial in the time before it. Eight terms: at 50
/// steps a period the rest over one step is below 2e-12 A, and that of the velocity below 1e-10 A omega.
struct PlatePath {
    std::array<double, 8> c; ///< of before^n

    /// z(t - before) and its time derivatives.
    double position(double before) const {
        double value = 0.0;
        for (std::size_t n = c.size(); n-- > 0;)
            value = value * before + c[n];
        return value;
    }
    double velocity(double before) const {
        double value = 0.0;
        for (std::size_t n = c.size(); n-- > 1;)
            value = value * before + static_cast<double>(n) * c[n];
        return -value; // the polynomial runs backwards in time
    }
    double acceleration(double before) const {
        double value = 0.0;
        for (std::size_t n = c.size(); n-- > 2;)
            value = value * before + static_cast<double>(n * (n - 1)) * c[n];
        return value;
    }
    /// At t itself.
    double position() const { return c[0]; }
    double acceleration() const { return 2.0 * c[2]; }
};

/// About time t, s.
PlatePath floor_path(const Plates& plates, double gravity, double time);

/// What plates did to some bodies during one step.
struct PlateTally {
    double floor_impulse = 0.0, lid_impulse = 0.0; ///< upward momentum given, N s
    std::int64_t impulses = 0;
    double max_overlap = 0.0;    ///< in radii, rods only
    double deepest_flight = 0.0; ///< how far a bead flew into a plate before it was put back, in radii
    std::size_t deepest = 0;     ///< number of the bead or rod that was deepest
};

struct PlateStep {
    PlatePath floor;
    double gap, time_step, gravity;

    /// Plates that do not vibrate (gamma = 0).
    bool still() const { return floor.velocity(0.0) == 0.0 && floor.acceleration() == 0.0; }
};

/// One plate seen from the particles: side +1 the floor (normal up), -1 the lid (normal down).
struct Plate {
    double side;
    const PlateStep* step;

    double height(double before) const {
        return step->floor.position(before) + (side > 0.0 ? 0.0 : step->gap);
    }
    double speed(double before) const { return step->floor.velocity(before); }
    /// Acceleration with which a free body is pressed against it; negative where the plate runs away.
    double pressing() const { return side * (step->gravity + step->floor.acceleration()); }
    double pressing(double before) const { return side * (step->gravity + step->floor.acceleration(before)); }
    double& impulse(PlateTally& tally) const { return side > 0.0 ? tally.floor_impulse : tally.lid_impulse; }
};

} // namespace rodwake::granular
