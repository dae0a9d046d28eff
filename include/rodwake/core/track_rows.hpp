#pragma once
// Rows of a file of tracks: which particle was seen where in which frame of a film.

#include "rodwake/core/periodic.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake {

/// The id of a spot that belongs to no track.
inline constexpr std::int64_t no_track = std::numeric_limits<std::int64_t>::min();

/// What programs write tracks in. CSV is read here; films of the others are made by rodwake convert.
enum class TrackFormat { automatic, csv, trackmate, lammps, xyz, gsd, h5md };
inline constexpr std::string_view track_format_names[] = {"automatic", "csv", "trackmate", "lammps",
                                                          "xyz",       "gsd", "h5md"};
constexpr std::string_view to_string(TrackFormat format) {
    return track_format_names[static_cast<std::size_t>(format)];
}

/// As the file has them, column by column, in any order.
struct TrackRows {
    std::vector<std::int64_t> frame; ///< empty with times
    std::vector<double> time;        ///< s; empty with frames
    std::vector<std::int64_t> id;
    std::vector<double> x, y;    ///< in units of the file, finite
    std::vector<double> heading; ///< rad; empty: no such column; NaN: not known
    /// Between the ends of rods, where the file has ends, whose direction is the heading; else empty. NaN as
    /// heading.
    std::vector<double> length;
    std::vector<double> radius;       ///< of beads, in units of the file; NaN: not known. Empty: not read
    std::vector<std::uint8_t> is_rod; ///< empty: no column of kinds, all are beads
    /// Image indices: x + image_x L is unwrapped. Empty: the file does not have them.
    std::vector<std::int32_t> image_x, image_y;
    /// Ids of a simulation never change hands; a tracker of pictures may give one to another particle.
    bool certain_ids = false;
    std::size_t without_place = 0;     ///< rows that were left out
    std::string first_without_place;   ///< where: "file:line"
    std::size_t branches = 0;          ///< links cut where a track splits or merges
    std::size_t hidden = 0;            ///< spots that TrackMate's filters took out
    std::size_t dangling = 0;          ///< links to spots that the file does not have
    std::vector<std::string> warnings; ///< of the reader, a sentence each
    std::string length_unit;           ///< as the file names it; empty: it does not
    std::optional<PeriodicBox> box;    ///< periodic in x and y, as the file says; in units of the file
    std::string no_box;                ///< why the file's periodic box is none here; else empty

    std::size_t size() const { return x.size(); }
};

/// What is done about a camera's errors: b = 4 sigma_0^2 that they add to every mean-square displacement.
struct Localisation {
    bool find = false;  ///< b as the shortest lags have it
    double given = 0.0; ///< else sigma_0, of a coordinate, m; 0: nothing is taken off

    bool operator==(const Localisation&) const = default;
};

/// How far a particle may go from one frame to the next, or over a gap, without being another one.
struct StepLimit {
    std::optional<double> length =
        {}; ///< m; infinite: unlimited; absent: by the spacing, and the tracker's ids

    bool operator==(const StepLimit&) const = default;
};

} // namespace rodwake
