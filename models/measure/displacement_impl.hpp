#pragma once
// Sums of exp(i G_k.r) in bins around the rod: what the estimators `phase` and `density` need.
//
// phase:   in the box's frame, the mean phase of the far field taken off in each frame (the crystal drifts).
//          In a window, whose crystal turns and strains, G_k is found anew in each block of time
//          (far_lattice.hpp): its frames wait until they are all there.
// density: in the rod's frame (wave vectors turned to the rod's heading at the start of the block), nothing
//          taken off: the Fourier content at G_k of the time-averaged density around the rod.

#include "blocks.hpp"
#include "common_beads.hpp"
#include "plane_waves.hpp"
#include "rod_view.hpp"

#include "rodwake/measure/displacement.hpp"

#include <optional>
#include <variant>

namespace rodwake::measure {

class PhaseAccumulator {
public:
    /// Channels of a bin: real and imaginary parts of the three sums, beads, places from the bin's middle.
    enum Channel : std::size_t { re0, im0, re1, im1, re2, im2, beads, place_x, place_y, channels };

    /// Throws InputError for the density in a window.
    PhaseAccumulator(const Layout& layout, const DisplacementOptions& options);

    /// Whether the frame was used: not if no bead is far from every rod.
    bool add(const Frame& frame);
    /// In a window: takes in the frames of the last block of time, which wait for its lattice.
    void finish();
    void save(StateWriter& out) const;
    void load(StateReader& in);

    /// Of the first frame; in a window, of the first block.
    const std::optional<BraggPeaks>& peaks() const { return peaks_; }
    const BraggPeaks& peaks(std::size_t block) const {
        return block < block_peaks_.size() ? block_peaks_[block] : *peaks_;
    }
    std::span<const BlockSums> blocks() const { return blocks_.all(); }

private:
    /// `G`: at the time of the frame.
    bool take(const Frame& frame, const std::array<Vector2, 3>& G, const BraggPeaks& peaks);

    Layout layout_;
    DisplacementOptions options_;
    RodGrid grid_;
    std::optional<BraggPeaks> peaks_;
    std::vector<BraggPeaks> block_peaks_; ///< [blocks], in a window
    std::vector<Frame> waiting_;          ///< of one block of time, in a window
    Blocks blocks_;
    std::vector<PhaseFactors> waves_; ///< of the frame at hand, in the box's frame; no state
};

void save(StateWriter& out, const std::optional<BraggPeaks>& peaks);
std::optional<BraggPeaks> load_peaks(StateReader& in);

// Displacement of each bead from where it was before the rod came, the mean displacement of all beads taken
// off, in the bin of that place. No lattice is needed.
//
// Where it was: its mean place while it was in the zone ahead, 0.3 L < x < 0.45 L in the rod's frame; before
// it has been there, its place in the first frame if that was ahead already, 0.15 L < x < 0.45 L. Other beads
// do not count until they have come through the zone. A bead that comes back to it gets a new place.
//
// What is counted must not depend on how a bead rattles. So a bead enters the zone anew only after it was
// nearer than 0.25 L (or behind the rod); its samples wait until it leaves the zone, when its mean place is
// known, of each stay the first 512; and places within 0.03 L of the front edge, where it depends on the
// rattling whether a sample belongs to the old or to the new place, do not count.

class LagrangianAccumulator {
public:
    /// Channels of a bin: displacement along and across the rod, beads, places from the bin's middle.
    enum Channel : std::size_t { along, across, beads, place_x, place_y, channels };

    LagrangianAccumulator(const Layout& layout, const DisplacementOptions& options);

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    std::span<const BlockSums> blocks() const { return blocks_.all(); }

private:
    /// Bead and rod, drift removed, unwrapped.
    struct Sample {
        double x, y;
        RodPosition rod;
        std::size_t block;
    };

    void take(std::size_t bead, const Sample& sample);
    void count(std::size_t bead, const Sample& sample);
    double side() const { return grid_.box.x - 2.0 * grid_.margin; }

    Layout layout_;
    DisplacementOptions options_;
    RodGrid grid_;
    Blocks blocks_;
    std::vector<double> place_x_, place_y_;    ///< [beads] sums of drift-free places before the rod came
    std::vector<double> samples_;              ///< [beads] how many; 0: unknown
    std::vector<double> in_zone_;              ///< [beads] 1 from its entry until it is left behind
    std::vector<std::vector<Sample>> waiting_; ///< [beads] of this stay in the zone
    double first_x_ = 0.0, first_y_ = 0.0;     ///< mean of all beads in the first frame
    double drift_x_ = 0.0, drift_y_ = 0.0;     ///< of that mean until the frame at hand
    BeadPlaces last_;                          ///< where beads come and go: in the frame before
};

// What a DisplacementAccumulator holds: the sums of its estimator and what is common to all.

using EstimatorSums = std::variant<PhaseAccumulator, LagrangianAccumulator>;

struct DisplacementAccumulator::Impl {
    Impl(const Layout& layout_in, const DisplacementOptions& options_in);

    void add(const Frame& frame);

    Layout layout;
    DisplacementOptions options; ///< as given
    double far_from;             ///< m, worked out
    EstimatorSums sums;
    std::size_t frames = 0;
    double path = 0.0, duration = 0.0; ///< of the rod along its heading, m; s
    double last_time = 0.0;
    RodPosition last; ///< of the rod
};

struct DisplacementSums {
    static const DisplacementAccumulator::Impl& of(const DisplacementAccumulator& run) { return *run.impl_; }
    static void finish(DisplacementAccumulator& run) {
        if (auto* phase = std::get_if<PhaseAccumulator>(&run.impl_->sums))
            phase->finish();
    }
};

inline RodGrid grid_of(const DisplacementAccumulator& run) {
    return grid_seen_by(run.options().rod, run.layout(), run.options().spacing);
}

} // namespace rodwake::measure
