// Tracks that are in order, frame by frame, and what is known of them as a whole.

#include "rodwake/measure/tracks.hpp"

#include "track_rods.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

double Tracks::mean_length() const {
    const std::size_t tracked = x.size() - static_cast<std::size_t>(std::ranges::count(bead, untracked));
    return beads > 0 ? static_cast<double>(tracked + counts.missing) / static_cast<double>(beads) : 0.0;
}

std::size_t Tracks::frames_with_beads() const {
    std::size_t count = 0;
    for (std::size_t f = 0; f < frames(); ++f)
        count += start[f + 1] > start[f];
    return count;
}

double Tracks::beads_per_frame() const {
    return static_cast<double>(x.size()) / static_cast<double>(std::max<std::size_t>(frames_with_beads(), 1));
}

double Tracks::mean_square_radius() const {
    double sum = 0.0;
    for (const double one : radius)
        sum += std::pow(one / bead_radius, 2);
    return radius.empty() ? 1.0 : sum / static_cast<double>(radius.size());
}

double Tracks::lost_share() const {
    const double seen = mean_length() * static_cast<double>(beads);
    return seen > 0.0 ? static_cast<double>(counts.missing) / seen : 0.0;
}

Layout layout_of(const Tracks& tracks, std::size_t stride) {
    Layout layout{tracks.box, tracks.bead_radius, 0.0,
                  static_cast<std::size_t>(std::max(1.0, std::round(tracks.beads_per_frame()))),
                  tracks.rods.size()};
    layout.window = tracks.window;
    layout.velocities = false;
    layout.kind_radii = tracks.kind_radii;
    for (const RodTrack& rod : tracks.rods) // where there is none yet, along x
        layout.headings.push_back(first_heading(rod).value_or(0.0));
    const bool all = tracks.beads > 0 && tracks.x.size() == tracks.frames() * tracks.beads &&
                     std::ranges::count(tracks.bead, untracked) == 0;
    layout.all_beads = all ? 0 : std::max<std::size_t>(tracks.beads, 1);
    if (!tracks.has_all_frames() || tracks.frames_with_beads() < tracks.frames()) // others are not measured
        layout.grid = tracks.on_grid ? tracks.interval * static_cast<double>(stride) : 0.0;
    return layout;
}

void for_each_frame(const Tracks& tracks, std::size_t stride,
                    const std::function<bool(const Frame&, double)>& use) {
    const Layout layout = layout_of(tracks);
    Unwrapping unwrap_x(tracks.beads), unwrap_y(tracks.beads);
    RodPlayer rods(tracks);
    Frame frame;
    for (std::size_t f = 0; f < tracks.frames(); ++f) {
        const auto from = static_cast<std::ptrdiff_t>(tracks.start[f]),
                   to = static_cast<std::ptrdiff_t>(tracks.start[f + 1]);
        frame.time = tracks.time[f];
        frame.x.assign(tracks.x.begin() + from, tracks.x.begin() + to);
        frame.y.assign(tracks.y.begin() + from, tracks.y.begin() + to);
        frame.unwrapped_x = frame.x;
        frame.unwrapped_y = frame.y;
        frame.bead.assign(tracks.bead.begin() + from, tracks.bead.begin() + to);
        if (!layout.kind_radii.empty())
            frame.kind = kinds_of({tracks.radius.begin() + from, tracks.radius.begin() + to}, layout);
        for (std::size_t i = 0; !tracks.window && i < frame.x.size(); ++i)
            if (const std::uint32_t bead = frame.bead[i]; tracks.has_images) { // as beds do
                const std::size_t row = tracks.start[f] + i;
                frame.unwrapped_x[i] = std::fma(tracks.image_x[row], tracks.box.x, frame.x[i]);
                frame.unwrapped_y[i] = std::fma(tracks.image_y[row], tracks.box.y, frame.y[i]);
            } else if (bead != untracked) {
                frame.unwrapped_x[i] = unwrap_x(bead, frame.x[i], tracks.box.x);
                frame.unwrapped_y[i] = unwrap_y(bead, frame.y[i], tracks.box.y);
            }
        if (layout.all_beads == 0)
            frame.bead.clear();
        rods.play(f, frame.rods);
        if (static_cast<std::size_t>(tracks.tick[f]) % stride == 0 &&
            !use(frame, static_cast<double>(f + 1) / static_cast<double>(tracks.frames())))
            return;
    }
}

} // namespace rodwake::measure
