#pragma once
// Frames as GSD 2 of the schema hoomd 1.4, for OVITO, freud, HOOMD-blue and gsd. The file appears at commit.
//
// Chunks: configuration/box and step, particles/N, types, typeid, mass, diameter, body (of a rod: its number
// from 0; -1: none), and in every frame position, velocity and image; log/time (s) and log/<observable> in
// double precision. The box is centred at 0, as the schema wants it. All else is in single precision: for
// numbers take H5MD.

#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/frames.hpp"

#include <filesystem>
#include <limits>
#include <memory>

namespace rodwake::store {

class GsdWriter {
public:
    /// Lengths are written in units of `length_unit` (m), velocities in length_unit/s. Throws InputError for
    /// a layout or unit that is none, RunError if the file cannot be made.
    GsdWriter(const std::filesystem::path& target, FrameLayout layout, double length_unit = 1.0);
    ~GsdWriter();
    GsdWriter(const GsdWriter&) = delete;
    GsdWriter& operator=(const GsdWriter&) = delete;
    GsdWriter(GsdWriter&&) = delete;
    GsdWriter& operator=(GsdWriter&&) = delete;

    /// Throws RunError for a frame that does not fit (check_frame) or cannot be written.
    void add_frame(const Frame& frame);
    void commit();

private:
    struct Chunks;
    FrameLayout layout_;
    double unit_;
    PendingFile pending_;
    std::unique_ptr<Chunks> chunks_;
    std::int64_t last_step_ = std::numeric_limits<std::int64_t>::min();

    void add_layout();
};

} // namespace rodwake::store
