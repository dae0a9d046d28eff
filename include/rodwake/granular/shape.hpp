#pragma once
// Rods as rigid clumps: a row of overlapping spheres on one axis, filled as the solid of revolution of their
// union.
//
// Body frame: origin at the centre of mass, the axis a from the thick to the thin end (an apolar rod: from
// either end). Inertia tensor about the centre of mass: diag(axial, transverse, transverse), axis first.

#include <cstddef>
#include <vector>

namespace rodwake::granular {

enum class RodKind { motile, apolar };
/// linear: radii fall evenly along the axis; stepwise: in `segments` equal pieces of constant radius.
enum class Taper { linear, stepwise };

/// What a rod is made of. Lengths in m. Defaults: the brass rods of the paper.
struct RodShape {
    RodKind kind = RodKind::motile;
    Taper taper = Taper::linear;
    double length = 4.5e-3;         ///< end to end
    double thick_diameter = 1.1e-3; ///< motile: thick end; apolar: the middle
    double thin_diameter = 0.8e-3;  ///< thin end; apolar: both ends
    double density = 8500.0;        ///< kg/m^3
    std::size_t spheres = 12;       ///< >= 1; apolar: odd (an even row has no middle and starts to move)
    std::size_t segments = 4;       ///< of a stepwise taper; apolar: from the middle to one end

    bool operator==(const RodShape&) const = default;
};

/// A rigid row of spheres ready to move.
struct Clump {
    std::vector<double>
        offset; ///< of the sphere centres along the axis from the centre of mass, m, increasing
    std::vector<double> radius;      ///< m
    double mass = 0.0;               ///< kg
    double axial_inertia = 0.0;      ///< about the axis, kg m^2
    double transverse_inertia = 0.0; ///< about any line through the centre of mass across the axis, kg m^2

    /// Share of the mass that a sphere stands for where a rod is stored as its spheres, kg.
    double sphere_mass() const { return mass / static_cast<double>(radius.size()); }
    /// Distance of the furthest surface point from the centre of mass, m.
    double reach() const;
    /// Area it covers in plan view when it lies flat, m^2.
    double projected_area() const;
};

/// Mass properties in closed form (piecewise polynomials). Throws InputError for a shape that is none: not
/// positive, thinner than its length allows, apolar with an even number of spheres, a gap between
/// neighbouring spheres.
Clump make_clump(const RodShape& shape);

} // namespace rodwake::granular
