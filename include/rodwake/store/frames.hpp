#pragma once
// Frames of a run of spheres, some of them parts of rigid rods: what the trajectory formats are written from.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rodwake::store {

/// How a species is called: its place in FrameLayout::kinds is its number.
struct Species {
    std::string name;   ///< "bead"; no blanks
    std::string symbol; ///< chemical symbol, for readers that know only those
};

/// What is the same in every frame. N particles (loose spheres and spheres of rods), R rods. Lengths in m.
struct FrameLayout {
    std::array<double, 3> box{}; ///< from 0 to box in x, y, z
    std::array<bool, 3> periodic{true, true, false};
    std::vector<Species> kinds = {{"bead", "Al"}, {"rod", "Cu"}};
    std::vector<std::int32_t>
        species;                      ///< [N], < kinds.size(); 0 is a loose sphere, all others belong to rods
    std::vector<std::int32_t> id;     ///< [N], distinct
    std::vector<double> mass, radius; ///< [N], kg, m
    std::vector<std::int32_t> rod_of_sphere; ///< which rod < R each sphere of a rod belongs to
    std::vector<std::int32_t> rod_id;        ///< [R], distinct
    std::vector<double> rod_mass;            ///< [R], kg
    std::vector<std::string> observables;    ///< names of numbers given with each frame: no blanks, no '/'

    std::size_t particles() const { return species.size(); }
    std::size_t rods() const { return rod_id.size(); }
};

/// One moment. Vectors lie one after the other: [N][3], quaternions [R][4], real part first.
struct Frame {
    std::int64_t step = 0;
    double time = 0.0;                                  ///< s
    std::span<const double> position, velocity;         ///< [N][3], unwrapped, m, m/s
    std::span<const double> rod_position, rod_velocity; ///< [R][3], centre of mass, unwrapped, m, m/s
    std::span<const double> rod_orientation;            ///< [R][4], body to world
    std::span<const double> rod_angular_momentum;       ///< [R][3], world, kg m^2/s
    std::span<const double> observables;                ///< as many as FrameLayout names
};

/// Throws InputError for a layout that is none: counts that differ, no particles, numbers not finite or out
/// of range, names that the formats cannot hold.
void check_layout(const FrameLayout& layout);
/// The same layout, checked.
inline FrameLayout checked(FrameLayout layout) {
    check_layout(layout);
    return layout;
}

/// Throws RunError for a frame that does not fit the layout, is not finite, or not later than `after_step`.
void check_frame(const FrameLayout& layout, const Frame& frame, std::int64_t after_step);

/// A coordinate as the place in a periodic box of side L and the number of the box: x = place + L image with
/// 0 <= place < L, exact but for half a unit in the last place of L; exact for 0 <= x < L (image 0).
struct PeriodicCoordinate {
    double place = 0.0;
    std::int32_t image = 0;
};
using Wrapped [[deprecated("it is PeriodicCoordinate")]] = PeriodicCoordinate;

/// Throws RunError if x is not finite or more than 2^30 boxes away.
PeriodicCoordinate wrap(double x, double side);

/// All coordinates [n][3]; x and image 0 in directions that are not periodic.
struct WrappedVectors {
    std::vector<double> place;
    std::vector<std::int32_t> image;
};
WrappedVectors wrap(std::span<const double> positions, const FrameLayout& layout);

} // namespace rodwake::store
