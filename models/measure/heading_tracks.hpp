#pragma once
// What the measures of a rod's tracks share, defined in heading_diffusion.cpp; `measure` is named in
// messages.

#include "rodwake/measure/heading_track.hpp"

#include <cstddef>
#include <span>
#include <string_view>

namespace rodwake::measure {

/// Throws InputError without runs, or for one without two rows of everything.
void check_tracks(std::span<const HeadingTrack> runs, std::string_view measure);

/// Between the rows of the first run, s; even_rows finds out whether those of all are.
double common_step(std::span<const HeadingTrack> runs);

/// Rows that are evenly spaced: all, or all but the last; RunError otherwise.
std::size_t even_rows(const HeadingTrack& run, double step, std::string_view measure);

/// From one row to another along the mean of their headings, m.
double advance(const HeadingTrack& run, std::size_t from, std::size_t to);

} // namespace rodwake::measure
