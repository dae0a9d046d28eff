#pragma once
// Tracks of particles in a film, put in order: frame by frame, each particle under one number from where it
// comes to where it goes, in metres and seconds, with what could not be used counted.

#include "rodwake/core/periodic.hpp"
#include "rodwake/core/track_rows.hpp"
#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/heading_track.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::measure {

struct TrackScale {
    double pixel = 1.0;             ///< what 1 of the file is worth, m
    double frames_per_second = 1.0; ///< where rows have frames and no times
    double bead_radius = 0.0;       ///< a, m
    std::optional<PeriodicBox> box; ///< periodic, from 0 on, m; absent: a window
    std::optional<Window> window;   ///< m, in the coordinates of the file; absent: the hull of all particles
    double angle = 1.0;             ///< what 1 of the file's headings is worth, rad
    /// Headings say where the axis of a rod is: the thin end is the one that goes ahead.
    bool thin_end_ahead = false;
    /// A track that steps farther is cut, m; infinite: none is. Absent: ids that are certain (of a
    /// simulation, or in a periodic box, which no camera sees) are never cut, others where they step by more
    /// than three mean spacings of the particles, or by one after a gap.
    std::optional<double> longest_step = {};
    std::vector<double> kind_radii = {}; ///< of beads of several sizes: mean radius of each kind, m
};

/// What happened to the rows. A row is used, or counted once here.
struct TrackCounts {
    std::size_t rows = 0;         ///< with a place
    std::size_t repeated = 0;     ///< of a particle and frame that stand there before
    std::size_t outside = 0;      ///< of the window
    std::size_t untracked = 0;    ///< used, but in no track: they count where one frame is enough
    std::size_t missing = 0;      ///< places within tracks at which the particle was not seen
    std::size_t restarts = 0;     ///< where a track was cut: its number goes on elsewhere
    std::size_t empty_frames = 0; ///< of a grid of times, between the first and the last, without any row
    std::size_t dangling = 0;     ///< links to spots that the file does not have
    std::size_t headless = 0;     ///< rows of a rod whose thin end is not known
    std::size_t joined = 0;       ///< rods that went on under another number
};

/// Of one rod, where it was seen.
struct RodTrack {
    std::int64_t number = 0; ///< in the file
    std::vector<std::size_t> frame;
    std::vector<double> x, y;    ///< m, in the layout's box; unwrapped if the tracks have image indices
    std::vector<double> heading; ///< of the thin end, rad; NaN: not known
};

/// Frames that have no row do not exist here.
struct Tracks {
    std::vector<double> time; ///< [frames], s, rising
    /// [frames], from 0: whole numbers of intervals since the first frame, if at least a quarter of such a
    /// grid of times has frames; else how many frames were before.
    std::vector<std::int64_t> tick;
    double interval = 0.0; ///< s, of the grid; of a film on none the mean
    bool on_grid = true;
    std::vector<std::size_t> start;             ///< [frames + 1]: rows of a frame
    std::vector<std::uint32_t> bead;            ///< [rows], rising within a frame, `untracked` behind
    std::vector<double> x, y;                   ///< [rows], m, in the layout's box
    std::vector<double> radius;                 ///< [rows], m; empty: bead_radius
    bool has_images = false;                    ///< else beads and rods are unwrapped by the shortest steps
    std::vector<std::int32_t> image_x, image_y; ///< [rows], with image indices
    std::size_t beads = 0;                      ///< different ones
    std::vector<RodTrack> rods;
    TrackCounts counts;
    std::optional<Window> window; ///< with its box beginning at 0
    PeriodicBox box;
    double bead_radius = 0.0;
    std::vector<double> kind_radii;    ///< as in TrackScale
    std::string cut_rule;              ///< where tracks were cut, as counts.restarts says
    std::vector<std::string> warnings; ///< of the reader and of the film, a sentence each

    std::size_t frames() const { return time.size(); }
    std::size_t frames_with_beads() const;
    bool has_all_frames() const { return on_grid && tick.back() + 1 == static_cast<std::int64_t>(frames()); }
    /// Frames between which a bead is known, on average over the beads.
    double mean_length() const;
    /// Of the places between where tracks begin and end, how many are missing.
    double lost_share() const;
    /// On average over the frames that have beads: those with rods alone may be of another camera.
    double beads_per_frame() const;
    /// Mean over the rows of radius^2/bead_radius^2; 1 if beads have one size.
    double mean_square_radius() const;
};

/// Rods: a track that ends, and one that begins later near to where it was going, are of one rod, if there is
/// no other that could be it. Where the file has axes only, the thin end is the one towards which a rod moves
/// by more than a while its axis can be followed.
///
/// Throws InputError ("<file>: ...") for rows that are no film: no two frames, a box or window that does not
/// hold the particles.
Tracks ordered_tracks(TrackRows rows, const TrackScale& scale, const std::string& file);

/// What every `stride`-th frame of the tracks has.
Layout layout_of(const Tracks& tracks, std::size_t stride = 1);

/// Of one rod in every frame: places unwrapped, headings without jumps; NaN where they are not known.
HeadingTrack poses_of(const Tracks& tracks, std::size_t rod);

/// Frames at every `stride`-th tick from the first, with the fraction done; `use` may return false to stop.
void for_each_frame(const Tracks& tracks, std::size_t stride,
                    const std::function<bool(const Frame&, double)>& use);

} // namespace rodwake::measure
