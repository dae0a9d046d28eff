#pragma once
// Single-bead microrheology (paper Sec. III.B): mean-square displacement with the drift of all beads removed,
// its Laplace transform, and the stiffness of the effective potential of a bead.
//
//   Delta(t)   = <|x(t0 + t) - x(t0)|^2>,  x in the plane, the mean displacement of all beads taken off
//   Delta~(s)  = int_0^inf Delta(t) exp(-s t) dt
//   stiffness  = 1/(s Delta~(s)) as s -> 0,  1/m^2;  k = 4 m T_xy times it, N/m, by equipartition (m T_xy in
//                place of the temperature; the 4 belongs to Delta = 4 T/k of a bound bead in the plane)
//
// Multi-tau: lags 1..16 frames, then 8 more an octave; each octave uses every second frame of the one before
// (no averaging: that would bias Delta). Frames must be evenly spaced; of a film some may be missing, which
// then are no origins. Where the frames of a film lie on no grid, each two of the last 64 of an octave of
// frames count at their own lag: lags that agree to a sixteenth of an octave, 4 %, are put together under
// their mean.
//
// Beads that come and go (tracks, frame.hpp): every two frames of one bead at a lag count, and the drift is
// summed up from frame to frame, over the beads that are in both. `origins` is then the number of pairs over
// that of beads in a frame.
//
// A camera finds a place with an error of standard deviation sigma_0 in each coordinate, which adds
// b = 4 sigma_0^2 to Delta at every lag; its exposure takes a constant off. Both are the intercept of Delta
// at lag 0, as the first lags see it: from Delta_1, Delta_2, Delta_3 at 1, 2 and 3 frames
//
//   d_1 = Delta_2 - Delta_1,  d_2 = Delta_3 - Delta_2:  b = Delta_1 - d_1^2/d_2          for d_2 <= d_1
//                                                       b = Delta_1 - 2 d_1 + d_2        for d_2 >  d_1
//
// the former exact for free diffusion and for one time of relaxation, the latter (a parabola) for ballistic
// motion. Its error is that of the jackknife and what the same from 2, 4 and 6 frames says beyond noise.
// A window sees a part of a crystal, and what is common to the part goes with the drift. How much that may
// have been, the halves of the window tell: with D the difference of their mean displacements over a lag,
// <|D|^2>/4 would be the mean's share if the halves moved independently. Crystals move more alike than that;
// so it is no correction. It is added to Delta, and how far that takes every value is part of its error.
//
// Where d_2 < d_1/5 beads have gone round their cages between two frames: then noise and cage look alike, and
// none is found.

#include "rodwake/core/track_rows.hpp"
#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/memory_kernel.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/statistics.hpp"

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rodwake::measure {

struct MicrorheologyOptions {
    double longest_lag = 0.0; ///< s; 0: as long as the run allows
    /// Range of s for the extrapolation s -> 0, 1/s; absent: 2/t_max to 8/t_max with t_max the longest lag
    /// that has at least a quarter of the run's time origins. Why: lower, more than e^-2 of the transform is
    /// the tail's, not the data's; higher, times are too short to tell a cage that lasts from one that is
    /// left. A liquid gives s/(4 D), a line through 0, a bound bead a plateau.
    std::optional<double> s_low, s_high;
    Localisation localisation = {}; ///< of tracks
    /// The kind of beads that is measured; absent: all. The drift of all beads is subtracted.
    std::optional<std::size_t> kind = {};

    bool operator==(const MicrorheologyOptions&) const = default;
};

class MicrorheologyAccumulator {
public:
    MicrorheologyAccumulator(const Layout& layout, const MicrorheologyOptions& options);

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    const Layout& layout() const { return layout_; }
    const MicrorheologyOptions& options() const { return options_; }
    std::size_t frames() const { return times_.frames; }
    double interval() const;    ///< s; 0 before the second frame; on no grid the shortest lag
    double temperature() const; ///< T_xy, m^2/s^2, mean over the frames

    static constexpr std::size_t channels = 16, groups = 16;
    /// Of one lag. Beads are split into groups by the y of their first places, for the errors.
    struct LagSums {
        std::array<double, groups> sum{};   ///< of |dx|^2 over beads and origins
        std::array<double, groups> pairs{}; ///< where beads come and go: what `sum` is over
        double origins = 0.0;
        double time = 0.0;                         ///< of the lag times origins, s, on no grid
        double halves = 0.0, halves_origins = 0.0; ///< of tracks in a window: of |D|^2/4, and how many
    };
    /// By the lag in intervals; on no grid by the sixteenth of an octave.
    const std::map<long, LagSums>& lags() const { return lags_; }
    double lag(long key) const;                       ///< s
    double weight(long key, std::size_t group) const; ///< what the sum is over: beads times origins
    /// Whether the lag has at least a quarter of the run's time origins; where frames are missing or on no
    /// grid, whether it is at most three quarters of the film.
    bool is_well_known(long key) const;
    /// Whether `halves` are there.
    bool sees_a_part() const { return !layout_.velocities && layout_.window.has_value(); }

private:
    /// A frame of an octave; beads in the order of their groups, or of their names, rising.
    struct OctaveFrame {
        std::size_t tick = 0;
        double time = 0.0;
        std::vector<double> x, y;
        std::vector<std::uint32_t> bead;
    };
    void set_group_sizes(std::size_t beads);
    /// Displacements of a group's beads over one lag, summed.
    struct Moved {
        double x = 0.0, y = 0.0, beads = 0.0;
    };
    bool on_grid() const { return layout_.grid != 0.0; }
    bool within_longest(double seconds) const;
    void push(std::size_t level, const OctaveFrame& now);
    void correlate(const OctaveFrame& before, const OctaveFrame& now, LagSums& sums);
    void correlate_named(const OctaveFrame& before, const OctaveFrame& now, LagSums& sums);
    void add_halves(LagSums& sums, std::span<const Moved, groups> moved);
    void add_named(const Frame& frame);

    Layout layout_;
    MicrorheologyOptions options_;
    FrameTimes times_;
    double temperature_sum_ = 0.0;
    std::vector<double> first_x_, first_y_; ///< unwrapped places in the first frame, beads by group
    std::vector<std::size_t> order_;        ///< the beads by group; behind them those of other kinds
    std::size_t measured_ = 0;              ///< beads of the kind that is measured; without one all
    std::vector<double> group_sizes_;
    /// The last 16 frames (64 on no grid) of every 2^level-th frame, newest last.
    std::vector<std::vector<OctaveFrame>> levels_;
    std::map<long, LagSums> lags_;

    /// Of beads that come and go, [all beads]: first place without the drift until then, and group.
    struct NamedBeads {
        std::vector<double> start_x, start_y; ///< m; NaN: not seen yet
        std::vector<std::uint8_t> group;
        double drift_x = 0.0, drift_y = 0.0;  ///< m
        std::vector<std::uint32_t> last_bead; ///< of the last frame that has beads
        std::vector<double> last_x, last_y;   ///< unwrapped, m
    };
    NamedBeads named_;
};

struct MicrorheologyResult {
    std::vector<double> lag, msd, msd_error, origins;  ///< s, m^2
    std::vector<double> s, stiffness, stiffness_error; ///< 1/s, 1/(s Delta~(s)) in 1/m^2 over a range of s
    double s_low = 0.0, s_high = 0.0;                  ///< window of the extrapolation, 1/s
    /// s -> 0, 1/m^2. Its error is that of the scatter and of the bend together. Where beads hop now and then
    /// the curve bends towards 0 below the hopping rate: the value is the stiffness felt over times of 1/s in
    /// the window, and the bend says how far it may still fall.
    Estimate stiffness_zero;
    std::string no_stiffness; ///< of tracks: why stiffness and all that is made of it are unknown; else empty
    double scatter = 0.0;     ///< part of the error: from noise, 1/m^2
    double bend = 0.0; ///< part of the error: what the bend of the curve within the window, beyond noise,
                       ///< puts the straight line off at s = 0, 1/m^2
    StiffnessSpectrum spectrum;   ///< 1/(s Delta~(s)) over all s, for the memory kernel
    Estimate spring;              ///< k, N/m
    double temperature = 0.0;     ///< T_xy, m^2/s^2
    bool window_narrowed = false; ///< too few lags for the wanted window: the one used is given
    std::size_t frames = 0;
    // Of tracks:
    std::optional<Estimate> localisation; ///< sigma_0 as the first lags have it, m; nothing: unknown
    double taken_off = 0.0;     ///< b, m^2; how well it is known is in the errors of all curves and values
    std::vector<double> hidden; ///< [lag], m^2: what the drift may have taken along, part of all errors

    /// Takes the spring from another temperature, T_xy in m^2/s^2, known better than from the frames: those
    /// may all lie at one phase of the plates, a run's own mean is over all phases.
    void use_temperature(double T);
};

/// Errors: jackknife of the whole fit over runs if there are at least 4, else over groups of beads
/// (neighbouring groups move together a little, which this leaves out). Throws InputError for fewer than 32
/// frames (tracks: without any lag), accumulators of different options or intervals, and where as much is to
/// be taken off for the camera as beads move.
MicrorheologyResult reduce(std::span<const MicrorheologyAccumulator> runs);

} // namespace rodwake::measure
