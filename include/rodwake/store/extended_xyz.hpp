#pragma once
// Frames as extended XYZ (libAtoms), for viewers: OVITO, ASE. The file appears at commit.
//
// Line 2 of a frame: Lattice,
// Properties=species:S:1:pos:R:3:velo:R:3:id:I:1:molecule:I:1:radius:R:1:kind:S:1, pbc, Time (s), Step, and
// the observables by their names. Species and position come first, because readers of plain XYZ (VMD,
// MDAnalysis) take a line's first four entries. Spheres of one rod are one molecule, from 1; beads are 0.
// Positions are wrapped into the box. Numbers are the shortest that read back to the same double.

#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/frames.hpp"

#include <filesystem>
#include <limits>

namespace rodwake::store {

class ExtendedXyzWriter {
public:
    /// Lengths are written in units of `length_unit` (m), velocities in length_unit/s. Throws InputError for
    /// a layout or unit that is none, RunError if the file cannot be made.
    ExtendedXyzWriter(const std::filesystem::path& target, FrameLayout layout, double length_unit = 1.0);

    /// Throws RunError for a frame that does not fit (check_frame) or cannot be written.
    void add_frame(const Frame& frame);
    void commit();

private:
    FrameLayout layout_;
    double unit_;
    PendingFile pending_;
    std::int64_t last_step_ = std::numeric_limits<std::int64_t>::min();
};

} // namespace rodwake::store
