#pragma once
// Files of tracks as programs for films write them: rows of (frame, particle, x, y), in any order.
//
//   CSV        of trackpy, pandas and TrackMate: one header line; commas, semicolons or tabs; columns in any
//              order; an index without a name, fields in quotes, '#' lines and a byte order mark are fine.
//              TrackMate's three further header lines are passed over
//   TrackMate  XML: spots, the edges that link them, and which tracks count. Where a track splits or merges
//              it is cut: who goes on as whom is not known
//
// Places that are no numbers (empty, NaN) are left out and counted. Anything else that is wrong is an
// InputError that names file, line and column.

#include "rodwake/core/track_rows.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rodwake::store {

enum class TrackFormat { automatic, csv, trackmate };

/// Names of the columns of a CSV file; empty: by the usual names, where there are such.
struct TrackColumns {
    std::string frame, id, x, y, heading, kind;
    std::string time;              ///< in place of frame, s
    std::vector<std::string> ends; ///< of a rod, in place of heading: x, y of the thin end, x, y of the other
};

/// Hears the fraction read now and then; false: stop.
using TrackProgress = std::function<bool(double)>;

/// Throws InputError; after a stop the rows are those read so far.
TrackRows read_tracks(const std::filesystem::path& file, TrackFormat format, const TrackColumns& columns,
                      const TrackProgress& on_progress);

} // namespace rodwake::store
