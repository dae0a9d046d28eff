#pragma once
// The [measure] table of a scene, after units are resolved and every value is checked: what is measured of
// the granular run. SI, with the bed's own `a`. What is absent is not measured.

#include "rodwake/measure/statistics.hpp"

#include <optional>
#include <string>

namespace rodwake::scene {

struct Measure {
    bool order = false, microrheology = false, flow = false, pairs = false, force = false;
    bool phonons = false, mechanics = false, heading_diffusion = false;
    std::optional<measure::DisplacementMethod> displacement;
    std::optional<double> interval; ///< between the frames that are measured, s; absent: of the stored frames
    double from = 0.0;              ///< earlier frames are not measured, s
    std::optional<double> from_travel;    ///< nor those before the rod has come this far, m
    double block = 5.0;                   ///< s; one independent value for the errors
    long rod = 0;                         ///< whose frame
    std::optional<double> order_interval; ///< s; absent: at least 0.5 s
    measure::Neighbours order_neighbours = measure::Neighbours::cutoff;
    std::optional<double> order_cutoff;    ///< m; absent: first minimum of g(r)
    std::optional<double> s_low, s_high;   ///< of the extrapolation of the stiffness, 1/s
    std::optional<double> bead_drag;       ///< drag of the plates on a bead over its mass, 1/s
    std::optional<double> bead_drag_error; ///< 1/s; absent: unknown
    double flow_lag = 0.1;                 ///< s
    std::optional<double> flow_spacing;    ///< m; absent: 2 a
    std::optional<double> marked_within;   ///< m; absent: 6 a
    std::optional<double> marked_travel;   ///< m; absent: to the end
    std::optional<double> spacing;         ///< of the displacement's grid, m; absent: 1 a
    measure::Reference reference = measure::Reference::box;
    std::optional<double> far_from; ///< m; absent: 0.3 L
    bool mirror = false;
    bool run_maps = false;                  ///< the displacement of each run as well
    std::optional<double> profile_offset;   ///< y of the profile of U_y along x, m; absent: 4 a
    std::optional<double> contact_distance; ///< of a pair, m; absent: half a rod's length
    std::optional<double> phonon_interval;  ///< between the frames of currents, s; absent: at most 5 ms
    std::optional<double> phonon_lag;       ///< longest, s; absent: 1 s, at most half of block
    long phonon_waves = 4;                  ///< along a side of the box, at most
    std::optional<double> shear_speed;      ///< c_T, m/s; absent: from phonons if they are measured
    std::optional<double> inertia_factor;   ///< m*; absent: as mechanics measures it, else none is used
    std::optional<double> inertia_error;    ///< of it; absent: 0
    std::optional<double> heading_lag_low;  ///< s; absent: a tenth of the longest
    std::optional<double> heading_lag_high; ///< s; absent: a quarter of block or of a shorter run
    std::string trajectory; ///< file to measure in place of the run's own; empty: the run's own

    bool operator==(const Measure&) const = default;
};

/// Longest lag of the heading's change where so much time is measured, s.
inline double heading_lag_high(const Measure& m, double measured) {
    return m.heading_lag_high.value_or(0.25 * (m.block < measured ? m.block : measured));
}

} // namespace rodwake::scene
