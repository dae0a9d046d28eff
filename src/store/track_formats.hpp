#pragma once
// The readers of the formats of tracks, one each.

#include "rodwake/store/track_file.hpp"

namespace rodwake::store {

TrackRows read_track_csv(const std::filesystem::path& file, const TrackColumns& columns,
                         const TrackProgress& on_progress);
TrackRows read_trackmate(const std::filesystem::path& file);

} // namespace rodwake::store
