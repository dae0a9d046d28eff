#pragma once
// measure.rwc: what was measured of one run while it went on, to the bit; made at its end, put together with
// the other runs by the measure stage.

#include "rodwake/app/measure.hpp"

#include <filesystem>

namespace rodwake::app {

/// Throws RunError.
void write_records(const std::filesystem::path& file, const MeasurePlan& plan,
                   const measure::Measures& measures);

/// Nothing if there is no such file, or one of other [measure] keys. Throws InputError for a damaged one.
std::optional<measure::Measures> read_records(const std::filesystem::path& file, const MeasurePlan& plan);

} // namespace rodwake::app
