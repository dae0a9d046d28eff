#pragma once
// Displacement of each bead from where it was before the rod came, the mean displacement of all beads taken
// off, in the bin of that place.
//
// Where it was: its mean place while it was in the zone ahead, 0.3 L < x < 0.45 L in the rod's frame; before
// it has been there, its place in the first frame if that was ahead already, 0.15 L < x < 0.45 L. Other beads
// do not count until they have come through the zone. A bead that enters it anew gets a new place.

#include "rodwake/measure/displacement.hpp"

#include "block_sums.hpp"
#include "rod_view.hpp"

namespace rodwake::measure {

class LagrangianRecord {
public:
    /// Channels of a bin: displacement along and across the rod, beads, places from the bin's middle.
    enum Channel : std::size_t { along, across, beads, place_x, place_y, channels };

    LagrangianRecord(const Layout& layout, const DisplacementKeys& keys);

    void add(const Frame& frame);
    void pack(Packer& out) const;
    void unpack(Unpacker& in);

    std::span<const BlockSums> blocks() const { return blocks_.all(); }

private:
    void start(const Frame& frame, const RodView& rod);
    void note_zone(std::size_t bead, const Frame& frame, const Seen& now);
    void count(std::size_t bead, const Frame& frame, const RodView& rod, double* sums);

    Layout layout_;
    DisplacementKeys keys_;
    RodGrid grid_;
    Blocks blocks_;
    std::vector<double> place_x_, place_y_; ///< [beads] sums of drift-free places before the rod came
    std::vector<double> samples_;           ///< [beads] how many; 0: unknown
    std::vector<double> in_zone_;           ///< [beads] 1 while it is there
    double first_x_ = 0.0, first_y_ = 0.0;  ///< mean of all beads in the first frame
    double drift_x_ = 0.0, drift_y_ = 0.0;  ///< of that mean until the frame at hand
};

} // namespace rodwake::measure
