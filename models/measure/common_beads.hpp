#pragma once
// Beads that two frames have in common, where beads come and go.

#include "rodwake/measure/frame.hpp"

#include <cstddef>
#include <vector>

namespace rodwake::measure {

/// Which beads a frame has, rising; empty: all of them.
using BeadNames = std::vector<std::uint32_t>;

/// Calls use(i, j) for each name that is in both rising lists.
template<class Use>
void for_each_common(const BeadNames& now, const BeadNames& before, const Use& use) {
    for (std::size_t i = 0, j = 0; i < now.size() && j < before.size();) {
        const std::uint32_t at = now[i], past = before[j];
        if (at == past)
            use(i, j);
        i += at <= past;
        j += past <= at;
    }
}

/// Those that are tracked.
inline BeadNames names_of(const Frame& frame) {
    BeadNames bead = frame.bead;
    while (!bead.empty() && bead.back() == untracked)
        bead.pop_back();
    return bead;
}

/// Calls use(bead, i) for each bead of a frame that is in a track.
template<class Use>
void for_each_named(const Frame& frame, const Use& use) {
    for (std::size_t i = 0; i < frame.x.size(); ++i)
        if (frame.bead.empty() || frame.bead[i] != untracked)
            use(frame.bead.empty() ? i : std::size_t{frame.bead[i]}, i);
}

/// Those that are in a track, unwrapped.
struct BeadPlaces {
    BeadNames bead; ///< empty: all, or none
    std::vector<double> x, y;
};

inline BeadPlaces places_of(const Frame& frame) {
    BeadPlaces places{names_of(frame), frame.unwrapped_x, frame.unwrapped_y};
    if (!frame.bead.empty()) {
        places.x.resize(places.bead.size());
        places.y.resize(places.bead.size());
    }
    return places;
}

/// Calls use(i, j) for each bead that both have. Beads: something with the members of BeadPlaces.
template<class Beads, class Use>
void for_each_common_bead(const Beads& now, const Beads& before, const Use& use) {
    if (!now.bead.empty() || !before.bead.empty())
        return for_each_common(now.bead, before.bead, use);
    for (std::size_t i = 0; i < now.x.size() && i < before.x.size(); ++i)
        use(i, i);
}

/// Mean of the steps of the beads that both have; 0 if they have none.
struct MeanStep {
    double x = 0.0, y = 0.0;

    template<class Beads>
    MeanStep(const Beads& before, const Beads& now) {
        double count = 0.0;
        for_each_common_bead(now, before, [&](std::size_t i, std::size_t j) {
            x += now.x[i] - before.x[j];
            y += now.y[i] - before.y[j];
            count += 1.0;
        });
        if (count > 0.0) {
            x /= count;
            y /= count;
        }
    }
};

} // namespace rodwake::measure
