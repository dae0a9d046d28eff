#pragma once
// The readers of the formats of tracks, one each.

#include "rodwake/store/track_file.hpp"

#include <algorithm>
#include <string_view>

namespace rodwake::store {

TrackRows read_track_csv(const std::filesystem::path& file, const TrackColumns& columns,
                         const TrackProgress& on_progress);
TrackRows read_trackmate(const std::filesystem::path& file, const TrackColumns& columns);
TrackRows read_lammps_dump(const std::filesystem::path& file, const TrackColumns& columns,
                           const TrackProgress& on_progress);
TrackRows read_xyz_tracks(const std::filesystem::path& file, const TrackColumns& columns,
                          const TrackProgress& on_progress);
TrackRows read_gsd_tracks(const std::filesystem::path& file, const TrackColumns& columns,
                          const TrackProgress& on_progress);
TrackRows read_h5md_tracks(const std::filesystem::path& file, const TrackColumns& columns,
                           const TrackProgress& on_progress);

/// Whether a particle of this kind (type, species) is a rod.
inline bool names_rod(const TrackColumns& columns, std::string_view kind) {
    constexpr std::string_view usual[] = {"rod", "motile", "apolar"};
    return columns.rod_kinds.empty() ? std::ranges::find(usual, kind) != std::end(usual)
                                     : std::ranges::find(columns.rod_kinds, kind) != columns.rod_kinds.end();
}

} // namespace rodwake::store
