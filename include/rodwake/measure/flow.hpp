#pragma once
// Mean velocity of the beads in the frame that moves and turns with a rod (rod_grid.hpp), and how far single
// beads near the rod are dragged (paper Fig. bead_drag).
//
// Velocity of a bead: its displacement over `lag` divided by lag, the mean of all beads taken off, turned
// into the rod's frame at the middle of the lag, in the bin where the bead was halfway. A lag of many plate
// periods averages the bead's rattling away, which is far faster than the flow. The rod's frame turns, but
// what is shown is the velocity relative to the box: beads at rest have velocity 0, not -v0.

#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/rod_grid.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/statistics.hpp"

#include <cstdint>
#include <vector>

namespace rodwake::measure {

struct FlowOptions {
    std::size_t rod = 0;
    double spacing = 0.0; ///< wanted spacing of the grid, m; e.g. 2 a
    double lag = 0.0;     ///< s; a whole number of frames (rounded), at least one; of a film on no grid the
                          ///< two frames nearest to the lag, to half of it; 0: one frame
    double block = 5.0;   ///< s; at least the lag
    double marked_within =
        0.0; ///< m; beads this close to the rod's centre in the first frame are marked; e.g. 6 a
    /// m; marked beads are followed until the rod has travelled this far, e.g. 20 a; 0: to the last frame.
    double marked_travel = 0.0;

    bool operator==(const FlowOptions&) const = default;
};

/// A bead marked in the first frame, in the box's frame, unwrapped, drift of all beads removed. m.
struct MarkedBead {
    std::size_t bead = 0;
    double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0; ///< first and last frame that was followed; NaN: not seen
};

class FlowAccumulator {
public:
    FlowAccumulator(const Layout& layout, const FlowOptions& options);

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    struct FlowBlock {
        std::vector<double> vx, vy, ux, uy; ///< [bins] sums of the velocity and of its unit vector
        std::vector<double> count;
    };
    const Layout& layout() const { return layout_; }
    const FlowOptions& options() const { return options_; }
    const RodGrid& grid() const { return grid_; }
    const std::vector<FlowBlock>& blocks() const { return blocks_; }
    std::vector<MarkedBead> marked() const;
    /// Path of the rod along its heading since the first frame, while marked beads were followed, the drift
    /// of all beads removed, m.
    double rod_travel() const { return travel_; }
    double first_heading() const { return first_heading_; } ///< of the rod, rad
    std::size_t frames() const { return times_.frames; }

private:
    struct Past {
        double time = 0.0;
        std::size_t tick = 0;
        std::vector<double> x, y; ///< unwrapped
        RodPosition rod;
        std::vector<std::uint32_t> bead; ///< as Frame::bead, without those in no track
    };
    void start(const Past& now);
    void follow_marked(const Past& now);
    void take(const Past& before, const Past& now);

    Layout layout_;
    FlowOptions options_;
    RodGrid grid_;
    FrameTimes times_;
    std::vector<Past> past_; ///< oldest first; as many as the lag needs
    std::vector<FlowBlock> blocks_;
    double block_number_ = 0.0; ///< of the last block
    std::vector<std::size_t> marked_;
    std::vector<double> first_x_, first_y_, last_x_, last_y_; ///< of the marked; last: drift removed
    double first_heading_ = 0.0, travel_ = 0.0;
    double drift_x_ = 0.0, drift_y_ = 0.0; ///< mean displacement of all beads since the first frame
    RodPosition last_rod_;                 ///< where it was seen last
    double since_x_ = 0.0, since_y_ = 0.0; ///< mean displacement of all beads since then
    bool started_ = false;                 ///< the rod has been seen
};

struct FlowField {
    RodGrid grid;
    /// m/s; 0 with count 0 where no bead came. Standard errors from blocks of time of all runs; NaN:
    /// unknown, since beads came in one block only.
    std::vector<double> vx, vy, sigma_x, sigma_y;
    std::vector<double> unit_x, unit_y; ///< mean unit vector, |.| <= 1; 1: all beads move the same way
    std::vector<double> count;
    std::vector<MarkedBead> marked; ///< of the first run
    Estimate drag; ///< mean displacement of the marked beads along the rod's first heading, over runs, m
    /// The same over the rod's own travel: 1 dragged along, 0 left behind; over runs whose rod came at least
    /// a.
    Estimate drag_share;
    double near_speed = 0.0; ///< mean over the beads within 6 a of the rod of their bin's |v|, m/s
    std::size_t blocks = 0, frames = 0;
};

/// Throws InputError without a pair of frames a lag apart, or with accumulators of different options.
FlowField reduce(std::span<const FlowAccumulator> runs);

} // namespace rodwake::measure
