#pragma once
// The [tracks] table of a scene, after units are resolved and every value is checked: what a camera saw, in
// place of a granular run. SI, with its own `a`. What is absent and follows from other keys stays absent
// here.

#include "rodwake/core/periodic.hpp"
#include "rodwake/core/track_rows.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::scene {

/// tracks.columns: names in the file; empty: the usual ones.
struct TracksColumns {
    std::string frame, id, x, y, heading, kind;
    std::string radius;            ///< empty: beads have tracks.bead_radius, or that of their kind
    std::vector<std::string> ends; ///< of a rod: x and y of its thin end, then of its thick end

    bool operator==(const TracksColumns&) const = default;
};

/// Which end of a rod is the thin one: as the file says, or that which goes ahead.
enum class ThinEnd { given, ahead };

/// Automatic: the periodic box of the file if it has one, else the hull.
enum class WindowKind { automatic, hull, periodic, circle, rectangle };
inline constexpr std::string_view window_names[] = {"automatic", "hull", "periodic", "circle", "rectangle"};
constexpr std::string_view to_string(WindowKind kind) { return window_names[static_cast<std::size_t>(kind)]; }

/// tracks.window, in the coordinates of the file, m.
struct TracksWindow {
    WindowKind kind = WindowKind::automatic;
    std::vector<double> sizes; ///< of a circle: x, y, radius; of a rectangle: x0, y0, x1, y1

    bool operator==(const TracksWindow&) const = default;
};

/// One of [[tracks.bead_kinds]].
struct TracksKind {
    double radius = 0.0;            ///< m
    std::vector<std::string> names; ///< in the column of kinds; empty: beads are of the nearest radius

    bool operator==(const TracksKind&) const = default;
};

/// [tracks]
struct Tracks {
    std::string file;
    std::string rods_file; ///< of the rods alone; empty: they are in `file`
    TrackFormat format = TrackFormat::automatic;
    std::optional<double> frames_per_second; ///< 1/s; or time_column, or the file has times of its own
    std::string time_column;
    double pixel = 0.0;          ///< what 1 of the file is worth, m
    double bead_radius = 0.4e-3; ///< a, m
    double angle = 1.0;          ///< what 1 of the file's headings is worth, rad
    ThinEnd thin_end = ThinEnd::given;
    TracksColumns columns;
    std::vector<std::string> rod_kinds; ///< values of the column of kinds
    std::vector<TracksKind> bead_kinds; ///< empty: one
    std::string group;                  ///< of particles in H5MD
    TracksWindow window;
    std::optional<PeriodicBox> box; ///< m; with a periodic window; absent: the file's own
    Localisation localisation;
    StepLimit longest_step;

    bool operator==(const Tracks&) const = default;
};

} // namespace rodwake::scene
