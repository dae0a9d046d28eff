#pragma once
// One instant of a bed as the measures see it: beads and rods in the plane. The same numbers to the bit
// whether they come from a running simulation or from a stored trajectory: a coordinate is the place in the
// periodic box and the image index, and what is unwrapped is made from the two.

#include "rodwake/core/periodic.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/window.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rodwake::measure {

/// The centre of a force on the bed, which goes straight on from t = 0.
struct MovingForce {
    double x = 0.0, y = 0.0;   ///< at t = 0, m
    double vx = 0.0, vy = 0.0; ///< m/s
    double heading = 0.0;      ///< of the force from +x, rad

    bool operator==(const MovingForce&) const = default;
};

/// What is the same in every frame. SI.
struct Layout {
    PeriodicBox box;          ///< m
    double bead_radius = 0.0; ///< a, m
    double bead_mass = 0.0;   ///< kg
    std::size_t beads = 0, rods = 0;
    std::vector<double> headings = {};     ///< of the rods as they start, rad from +x; none: along x
    std::optional<MovingForce> force = {}; ///< of a bed without rods: stands for rod 0
    /// Of tracks of a camera what is seen, of a bed with a wall where the centres of beads may be, in place
    /// of a periodic box; `box` holds it, from 0 on.
    std::optional<Window> window = {};
    bool velocities = true; ///< false: tracks: places alone, and a rod may be missing
    /// Beads come and go: frames name those they have, of so many in all, and `beads` is how many they have
    /// on average. 0: every frame has all beads.
    std::size_t all_beads = 0;
    /// Of a film whose frames are not evenly spaced: time between neighbours of the grid on which they lie,
    /// some of them missing, s; 0: on none.
    std::optional<double> grid = {};
    std::vector<double> kind_radii = {}; ///< of beads of several sizes: mean radius of each kind, m

    bool operator==(const Layout&) const = default;
};

/// The window of a bed with a wall, a circle or a rectangle within these sides: centres of beads are 0.9 a
/// and more from the wall, into which a bead is pressed by less than the tenth of a at which runs stop.
Window room_within(bool round, const PeriodicBox& sides, double bead_radius);

/// Of the window, or of the box, m^2.
double seen_area(const Layout& layout);

/// In which differences to nearest images are those in the plane: around a window nobody has an image.
PeriodicBox image_box(const Layout& layout);

/// The box as rod `rod` (or the force) sees it: the side nearest to its first heading lies along its x.
PeriodicBox box_seen_by(std::size_t rod, const Layout& layout);

/// Throws InputError unless the box, the radius and, with velocities, the mass are finite and positive, the
/// box is at least 8 a and there are beads.
void validate(const Layout& layout);

/// Centre of mass of a rod. In tracks NaN says what is not known: of a rod that is not seen, all three.
struct RodPosition {
    double x = 0.0, y = 0.0; ///< unwrapped, m
    double heading = 0.0;    ///< of the thin end from +x, rad, in (-pi, pi]

    bool seen() const { return !std::isnan(x); }
    /// Seen, and its heading is known.
    bool known() const { return !std::isnan(heading); }
};
using RodPlace [[deprecated("it is RodPosition")]] = RodPosition;

struct Frame {
    double time = 0.0;                            ///< s, from the end of the equilibration
    std::vector<double> x, y;                     ///< [beads], m, in the box
    std::vector<double> unwrapped_x, unwrapped_y; ///< [beads], m, unwrapped: x + L_x * image index
    std::vector<double> vx, vy;                   ///< [beads], m/s
    std::vector<RodPosition> rods;                ///< [rods]
    /// [beads], rising: which of all beads they are; `untracked` of those seen once only. Empty: all of the
    /// layout.
    std::vector<std::uint32_t> bead = {};
    std::vector<std::uint8_t> kind = {}; ///< [beads], of several sizes: number in the layout's kind_radii
};

/// A bead of which nothing is known in other frames; behind all others of its frame.
inline constexpr std::uint32_t untracked = 0xFFFFFFFF;

/// For each of these radii, m, the kind whose mean radius is nearest, of equal ones the first; empty where
/// all beads have one size.
std::vector<std::uint8_t> kinds_of(std::span<const double> radii, const Layout& layout);

/// Of rod `rod`, or of the force.
RodPosition place_of(std::size_t rod, const Layout& layout, const Frame& frame);

/// Throws RunError for a frame that does not belong to the layout: counts, values that are not finite, places
/// outside the box.
void check_frame(const Layout& layout, const Frame& frame);

// Times of frames: evenly spaced, unless the layout says otherwise.

struct FrameTimes {
    std::size_t frames = 0;
    double last = 0.0, interval = 0.0; ///< s; interval 0 before the second frame, and on no grid
    double first = 0.0;                ///< s; of films with a grid alone
    /// Of the last frame: intervals since the first one; on no grid how many frames were before.
    std::size_t tick = 0;

    /// Counts the next frame in. Throws RunError ("measure: <what>: ...", with the times) if times do not
    /// grow or, without a grid, their steps differ by more than a millionth, which is far above the round-off
    /// of times.
    void next(double time, const char* what, const std::optional<double>& grid = {});
    /// No frame between the first and the last is missing.
    bool has_all_frames() const { return tick + 1 == frames && interval > 0.0; }
    void save(StateWriter& out) const;
    void load(StateReader& in);
};

} // namespace rodwake::measure
