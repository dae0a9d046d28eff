#pragma once
// Frames whose displacement field is known: a perfect triangular lattice that closes in the box, or a frozen
// bed of two sizes, each bead at r = X + U(X - rod) + noise, U the periodic field of a rod that moves at
// constant speed along a box axis, the bed drifting. Bead radius 1, of the smaller beads.

#include "rodwake/measure/frame.hpp"

#include "rodwake/elastic/periodic.hpp"

#include <Eigen/Core>

namespace measure_test {

struct WakeSetup {
    double box = 78.0;
    long beads = 1549;          ///< at least; as many as a lattice of about this angle has
    double lattice_angle = 0.0; ///< of close-saved rows, rad
    double heading = 0.0;       ///< whole multiple of pi/2
    rodwake::elastic::Medium medium{1.3, 16.0};
    double strength = 2.2;  ///< f/mu
    bool two_sizes = false; ///< half of the beads 1.4 times as large, at random places without overlaps
    double noise = 0.0;     ///< standard deviation of each coordinate
    double noise_time =
        0.0; ///< s; after t its correlation is exp(-t/noise_time); 0: independent in each frame
    double speed = 2.6, drift_x = 0.07, drift_y = 0.043; ///< in the box; of rod and of crystal
    double interval = 0.1;
    double core = 1.5;        ///< nearer to the rod the field is that at this distance
    double slip_within = 0.0; ///< rows that the rod has passed closer than this slip forwards by one spacing
    std::uint64_t seed = 1;
};

class SyntheticWake {
public:
    explicit SyntheticWake(const WakeSetup& setup);

    const rodwake::measure::Layout& layout() const { return layout_; }
    rodwake::measure::Frame frame(std::size_t number) const;
    /// In the rod's frame, at the undisplaced place.
    rodwake::elastic::Vector truth(double x, double y) const;
    double spacing() const { return spacing_; }     ///< of the lattice
    double row_angle() const { return row_angle_; } ///< that it really has

private:
    rodwake::elastic::Vector noise(std::size_t bead, double time) const;
    double slipped(const Eigen::Vector2d& site, const rodwake::measure::RodPosition& rod) const;

    WakeSetup setup_;
    rodwake::elastic::PeriodicField field_;
    rodwake::measure::Layout layout_;
    std::vector<Eigen::Vector2d> sites_;
    std::vector<double> rates_, phases_; ///< [bead][axis][wave] of noise with a memory
    double spacing_ = 0.0, row_angle_ = 0.0;
};

} // namespace measure_test
