#pragma once
// Sums of exp(i G_k.r) in bins around the rod: what the estimators `phase` and `density` need.
//
// phase:   in the box's frame, the mean phase of the far field taken off in each frame (the crystal drifts).
// density: in the rod's frame (wave vectors turned to the rod's heading at the start of the block), nothing
//          taken off: the Fourier content at G_k of the time-averaged density around the rod.

#include "rodwake/measure/displacement.hpp"

#include "block_sums.hpp"
#include "far_field.hpp"
#include "plane_waves.hpp"

#include <optional>

namespace rodwake::measure {

class PhaseRecord {
public:
    /// Channels of a bin: real and imaginary parts of the three sums, beads, places from the bin's middle.
    enum Channel : std::size_t { re0, im0, re1, im1, re2, im2, beads, place_x, place_y, channels };

    PhaseRecord(const Layout& layout, const DisplacementKeys& keys);

    /// Whether the frame was used: not if no bead is far from every rod.
    bool add(const Frame& frame);
    void pack(Packer& out) const;
    void unpack(Unpacker& in);

    /// Of the first frame.
    const std::optional<BraggPeaks>& peaks() const { return peaks_; }
    std::span<const BlockSums> blocks() const { return blocks_.all(); }

private:
    std::optional<Phases> far_phases(const Frame& frame) const;
    void count(const Seen& now, const Phases& waves, BlockSums& block) const;

    Layout layout_;
    DisplacementKeys keys_;
    RodGrid grid_;
    std::optional<BraggPeaks> peaks_;
    Blocks blocks_;
    std::vector<Phases> waves_; ///< of the frame at hand, in the box's frame; no state
};

void pack(Packer& out, const std::optional<BraggPeaks>& peaks);
std::optional<BraggPeaks> unpack_peaks(Unpacker& in);

} // namespace rodwake::measure
