#pragma once
// One instant of a bed as the measures see it: beads and rods in the plane. The same numbers to the bit
// whether they come from a running simulation or from a stored trajectory: a coordinate is the place in the
// periodic box and the number of the box, and what is unwrapped is made from the two.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rodwake::measure {

/// What is the same in every frame. SI.
struct Layout {
    double box = 0.0;         ///< side L of the periodic square, m
    double bead_radius = 0.0; ///< a, m
    double bead_mass = 0.0;   ///< kg
    std::size_t beads = 0, rods = 0;

    bool operator==(const Layout&) const = default;
};

/// Throws InputError unless the box, the radius and the mass are finite and positive, the box is at least 8 a
/// and there are beads.
void validate(const Layout& layout);

/// Centre of mass of a rod.
struct RodPlace {
    double x = 0.0, y = 0.0; ///< unwrapped, m
    double heading = 0.0;    ///< of the thin end from +x, rad, in (-pi, pi]
};

struct Frame {
    double time = 0.0;                  ///< s, from the end of the equilibration
    std::vector<double> x, y;           ///< [beads], m, in [0, L)
    std::vector<double> free_x, free_y; ///< [beads], m, unwrapped: x + L * number of the box
    std::vector<double> vx, vy;         ///< [beads], m/s
    std::vector<RodPlace> rods;         ///< [rods]
};

/// Throws RunError for a frame that does not belong to the layout: counts, values that are not finite, places
/// outside the box.
void check_frame(const Layout& layout, const Frame& frame);

/// A difference of coordinates taken to the nearest periodic image, in [-L/2, L/2].
double nearest(double difference, double box);

} // namespace rodwake::measure
