#pragma once
// What the measures of a rod's tracks share, defined in heading_diffusion.cpp; `measure` is named in
// messages.

#include "rodwake/measure/heading_track.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace rodwake::measure {

/// Throws InputError without runs, or for one without two rows of everything.
void check_tracks(std::span<const HeadingTrack> runs, std::string_view measure);

/// Between the rows of the first run, s, the least if they are not evenly spaced.
double common_step(std::span<const HeadingTrack> runs);

/// With rows of nothing where a film has none, and without a last row that is nearer; nothing if the times
/// are no such grid.
std::optional<HeadingTrack> even_track(const HeadingTrack& run, double step);

/// From one row to another along the mean of their headings, m.
double advance(const HeadingTrack& run, std::size_t from, std::size_t to);

} // namespace rodwake::measure
