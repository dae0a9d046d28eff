#pragma once
// Rods of tracks: which end is the thin one, who goes on as whom, and where they are frame by frame.

#include "rodwake/measure/tracks.hpp"

#include <optional>

namespace rodwake::measure {

/// With `join`, joins the tracks of rods whose number was lost; then, with `ahead`, turns axes into headings.
/// `spacing`: of the particles, m.
void settle_rods(Tracks& tracks, double spacing, bool ahead, bool join);

std::optional<double> first_heading(const RodTrack& rod);

/// Of one coordinate of every particle: its last place and the number of its box.
class Unwrapping {
public:
    explicit Unwrapping(std::size_t particles) : last_(particles, std::nan("")), image_(particles, 0) {}

    double operator()(std::size_t particle, double position, double side) {
        double& before = last_[particle];
        if (!std::isnan(before))
            image_[particle] += position - before > 0.5 * side ? -1 : position - before < -0.5 * side ? 1 : 0;
        before = position;
        return std::fma(static_cast<double>(image_[particle]), side, position);
    }

private:
    std::vector<double> last_;
    std::vector<std::int32_t> image_;
};

/// All rods of the tracks, frame after frame. Keeps the reference.
class RodPlayer {
public:
    explicit RodPlayer(const Tracks& tracks)
        : tracks_(tracks), next_(tracks.rods.size(), 0), x_(next_.size()), y_(next_.size()) {}

    /// Of the next frame.
    void play(std::size_t frame, std::vector<RodPosition>& positions);

private:
    const Tracks& tracks_;
    std::vector<std::size_t> next_; ///< row of each rod
    Unwrapping x_, y_;
};

} // namespace rodwake::measure
