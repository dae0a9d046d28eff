#pragma once
// Frames for the measures, from a running simulation or a stored trajectory: the same bits.

#include "rodwake/app/measure.hpp"
#include "rodwake/granular/state.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace rodwake::app {

/// `frame` is filled anew, its memory used again.
void fill_frame(measure::Frame& frame, const granular::State& state, double time, const PeriodicBox& box,
                const measure::Layout& layout);

/// Frames of a stored trajectory from the first, every `stride`, with the fraction done; `use` may return
/// false to stop. Throws InputError if the file cannot be read or is of another bed.
void for_each_frame(const std::filesystem::path& file, const measure::Layout& layout, std::size_t stride,
                    const std::function<bool(const measure::Frame&, double)>& use);

/// Throws InputError if the file cannot be read, is of another bed, or its frames do not fit the interval.
void check_trajectory(const std::filesystem::path& file, const MeasurePlan& plan);

/// Message for a run, recorded or stored, that has no frame to measure.
std::string why_no_frames(const measure::Measures& measures);

/// Measures of a stored trajectory at the plan's interval. `on_progress` hears the fraction done and may
/// return false to stop; then nothing is returned. Throws InputError if the file is of another bed, has no
/// frame to measure, or its frames do not fit the interval.
std::optional<measure::Measures> measure_trajectory(const std::filesystem::path& file,
                                                    const MeasurePlan& plan,
                                                    const std::function<bool(double)>& on_progress);

/// The same of a run's archive.rwc: its frames are made again, to the bits that it had measured on its way
/// (app/replay.hpp).
std::optional<measure::Measures> measure_archive(const std::filesystem::path& file, const MeasurePlan& plan,
                                                 const std::function<bool(double)>& on_progress);

/// Throws RunError.
void write_records(const std::filesystem::path& file, const MeasurePlan& plan,
                   const measure::Measures& measures);

/// Nothing if there is no such file, or one of other [measure] keys. Throws InputError for a damaged one.
std::optional<measure::Measures> read_records(const std::filesystem::path& file, const MeasurePlan& plan);

} // namespace rodwake::app
