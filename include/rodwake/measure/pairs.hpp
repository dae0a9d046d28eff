#pragma once
// Two rods of a granular run: how their separation changed, who turned, how it ended. From tracks
// (tracks.csv), not from frames.

#include "rodwake/core/encounter.hpp"
#include "rodwake/measure/statistics.hpp"

#include <optional>
#include <span>
#include <vector>

namespace rodwake::measure {

/// Track of two rods of one run; unwrapped, m, rad, s. All of one length.
struct PairTrack {
    std::vector<double> t;
    std::vector<double> x[2], y[2], heading[2];
};

struct PairOptions {
    PeriodicBox box;               ///< m; without images: around the window
    double contact_distance = 0.0; ///< between centres of mass, m; e.g. one rod length
    EndingCriteria ending = noisy_track;
    bool images = true; ///< the box is periodic

    bool operator==(const PairOptions&) const = default;
};

/// One run.
struct PairRun {
    double separation = 0.0; ///< d0 across the mean first heading, m (perpendicular starts: distance)
    std::optional<double> half_box_change; ///< Delta y when the rods have come L/2 along their mean first
                                           ///< heading on average, m; absent: they have not
    double last_change = 0.0;              ///< Delta y at the end, m, outwards positive
    double turn[2] = {}; ///< net turn of each rod towards (+) or away from (-) the other's first place, rad
    int leader = 0;      ///< who was ahead along the mean first heading when the pair had turned most
    /// (|turn of the rear| - |turn of the front|)/(sum of both), in [-1, 1]; 0 if neither turned.
    double non_reciprocity = 0.0;
    double min_separation = 0.0;       ///< nearest images, m
    Ending ending = Ending::undecided; ///< core/encounter.hpp
    double ending_time = 0.0;   ///< s; first contact, begin of the lock of a pursuit, or end of the track
    bool perpendicular = false; ///< first headings more than 60 and less than 120 degrees apart
};

/// Rods that head opposite ways have no common ahead: changes 0, half a box never, leader 0, non-reciprocity
/// 0, d0 the distance. First places count as those of the nearest images. Throws InputError for a track of
/// fewer than 2 rows, lengths that differ, values that are not finite, times that do not grow, or options
/// that are not positive.
PairRun follow_pair(const PairTrack& track, const PairOptions& options);

struct PairResult {
    std::vector<PairRun> runs;
    Estimate half_box_change;  ///< over the runs that came half a box
    std::size_t not_there = 0; ///< runs that did not
    Estimate non_reciprocity, turn_rear, turn_front;
    std::size_t contact = 0, pursuit = 0, escape = 0, undecided = 0;
};

/// Throws InputError without runs.
PairResult reduce(std::span<const PairRun> runs);

} // namespace rodwake::measure
