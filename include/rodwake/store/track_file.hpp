#pragma once
// Files of tracks as programs for films write them: rows of (frame, particle, x, y), in any order.
//
//   CSV        of trackpy, pandas and TrackMate: one header line; commas, semicolons or tabs; columns in any
//              order; an index without a name, fields in quotes, lines that begin with '#' or '%', a byte
//              order mark and gzip are fine. TrackMate's three further header lines are passed over
//   TrackMate  XML: spots, the edges that link them, and which tracks count. Where a track splits or merges
//              it is cut: who goes on as whom is not known
//   LAMMPS     dumps: x, xu, xs or xsu; ids in any order; box, and times where the dump has them
//   extended XYZ   Lattice, Properties, Time, Step; without ids a line is who it is by its place in the frame
//   GSD        schema hoomd: position, box, step, typeid, orientation
//   H5MD       of any program: 2 or 3 dimensions, ids that change with time, fixed steps and times
//
// The content tells which it is, else the name's ending. The last four know their box and their steps, and
// some their times.
//
// Places that are no numbers (empty, NaN) are left out and counted. Anything else that is wrong is an
// InputError that names file, line and column.

#include "rodwake/core/track_rows.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rodwake::store {

enum class TrackFormat { automatic, csv, trackmate, lammps, xyz, gsd, h5md };

/// Names of the columns (of CSV, LAMMPS) and what they mean; empty: by the usual names, where there are such.
struct TrackColumns {
    std::string frame, id, x, y, heading, kind;
    std::string time;              ///< in place of frame, s
    std::vector<std::string> ends; ///< of a rod, in place of heading: x, y of the thin end, x, y of the other
    bool own_times = false;        ///< neither frames nor a column of times count: the file's own times
    std::vector<std::string> rod_kinds;  ///< values of `kind` that are rods; empty: rod, motile, apolar, 1
    std::string group;                   ///< of H5MD, the particles; empty: trajectory, or the only one
    std::size_t most_rows = 100'000'000; ///< a CSV with more is refused, before the memory is used up
};

/// Hears the fraction read now and then; false: stop.
using TrackProgress = std::function<bool(double)>;

/// Throws InputError; after a stop the rows are those read so far.
TrackRows read_tracks(const std::filesystem::path& file, TrackFormat format, const TrackColumns& columns,
                      const TrackProgress& on_progress);

/// Columns frame (or t, where there are times), particle, x, y, and theta and kind where the rows have them;
/// an empty cell is a spot of no track or an unknown heading. Numbers read back to the bit; boxes and image
/// indices are not kept. Throws RunError.
void write_plain_csv(const TrackRows& rows, const std::filesystem::path& file);

} // namespace rodwake::store
