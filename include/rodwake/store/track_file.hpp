#pragma once
// Files of tracks: rows of (frame, particle, x, y), in any order, as programs for films write them.
//
//   CSV    of trackpy, pandas and TrackMate: one header line; commas, semicolons or tabs; columns in any
//          order; an index without a name, fields in quotes, lines that begin with '#' or '%', a byte order
//          mark and gzip are fine. TrackMate's three further header lines are passed over
//   film   H5MD that rodwake convert wrote from any other format: beads and rods apart, padded to the
//          largest frame, with the box, the image indices and the times that the file has
//
// Places that are no numbers (empty, NaN) are left out and counted. Anything else that is wrong is an
// InputError that names file, line and column.

#include "rodwake/core/track_rows.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rodwake::store {

/// Beads that are named by their kind, and their radius in units of the file.
struct NamedRadius {
    std::vector<std::string> names;
    double radius;
};

/// Names of the columns of CSV and what they mean; empty: by the usual names, where there are such.
struct TrackColumns {
    std::string frame, id, x, y, heading, kind;
    std::string time;              ///< in place of frame, s
    std::vector<std::string> ends; ///< of a rod, in place of heading: x, y of the thin end, x, y of the other
    bool own_times = false;        ///< neither frames nor a column of times count: the file's own times
    std::vector<std::string> rod_kinds;  ///< values of `kind` that are rods; empty: rod, motile, apolar, 1
    std::size_t most_rows = 100'000'000; ///< a CSV with more is refused, before the memory is used up
    std::string radius = {};             ///< of beads; empty: not read
    std::vector<NamedRadius> kinds = {}; ///< without a column of radii: radii by `kind`
};

/// Hears the fraction read now and then; false: stop.
using TrackProgress = std::function<bool(double)>;

/// How the file begins tells its format, else its name's ending. Throws InputError if there is no such file.
TrackFormat track_format(const std::filesystem::path& file);

/// Throw InputError; after a stop the rows are those read so far. A film gives its times with `own_times`,
/// else its steps as frames; `source` is the file that it was made from, for messages.
TrackRows read_track_csv(const std::filesystem::path& file, const TrackColumns& columns,
                         const TrackProgress& on_progress);
TrackRows read_film(const std::filesystem::path& film, const std::string& source, bool own_times,
                    bool with_radii, const TrackProgress& on_progress);

/// Columns frame (or t, where there are times), particle, x, y, and theta and kind where the rows have them;
/// an empty cell is a spot of no track or an unknown heading. Numbers read back to the bit; boxes and image
/// indices are not kept. Throws RunError.
void write_plain_csv(const TrackRows& rows, const std::filesystem::path& file);

} // namespace rodwake::store
