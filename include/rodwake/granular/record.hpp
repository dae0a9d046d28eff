#pragma once
// What is kept of a run while it goes on: running means, one row of numbers at an interval, the rods' tracks.
// Long runs need not store frames.

#include "rodwake/granular/simulation.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace rodwake::granular {

/// One row of table.csv. SI.
struct TableRow {
    double t, energy, kinetic, T_xy, T_z; ///< T: means over the interval before the row
    double psi6, contacts;                ///< now; overlapping pairs per step over the interval
    double floor_impulse, lid_impulse;    ///< upward momentum given since the start (lid: negative), N s
    double max_overlap;                   ///< since the start, radii
    PlaneTensor pressure; ///< mean over the interval before the row, N/m; in the first row the kinetic part

    static std::array<const char*, 13> names();
    std::array<double, 13> values() const; ///< in the order of the names
};

/// Where a rod is in a row of tracks.csv. SI, angles in rad; heading without jumps.
struct TrackPoint {
    double x, y, z, heading, pitch;
    double speed;            ///< along its heading, mean since the row before, m/s
    double impulse_on_beads; ///< momentum given to the beads along its heading since t = 0, N s

    static std::array<const char*, 7> names();
};

/// How far a rod came, forward along its own heading, since t = 0.
struct RodProgress {
    double x0, y0, heading0;       ///< at t = 0
    double x, y, heading;          ///< at the last sample; heading without jumps
    double travelled;              ///< integral of velocity along the heading, m
    double impulse_on_beads_at[2]; ///< in-plane Tallies::impulse_on_beads at the last sample
    double
        impulse_on_beads; ///< momentum given to the beads along the heading of each moment since t = 0, N s
    double row_travelled; ///< at the last row
};

/// Momentum that a rod got from the plates along the heading of each moment since t = 0. Over the time that
/// is its thrust: of a rod that walks freely and steadily as much as its force on the beads, of a lone one
/// zero.
struct RodThrust {
    double impulse_at[2]; ///< in-plane Tallies::impulse_from_plates at the last sample
    double impulse;       ///< N s
};

/// What the pressure is made of (observe.hpp).
struct PressureSums {
    PlaneTensor run_flux, row_flux;     ///< sums over the samples of SampleSums
    PlaneTensor run_virial, row_virial; ///< of the tallies at t = 0 and at the last row
};

struct SampleSums {
    double T_xy, T_z;
    std::int64_t count;
};

/// Two rods: the change of their separation across their mean first heading (PairCourse), outwards positive.
struct PairProgress {
    double change;          ///< at the last sample, m
    double half_box_time;   ///< when they had come half the side along which they head; negative: not yet
    double half_box_change; ///< then
};

/// The accumulators; plain numbers, stored whole in checkpoints.
struct RecordSums {
    SampleSums run, row;             ///< since t = 0; since the last row
    double psi6;                     ///< sum over rows since t = 0
    std::int64_t rows;               ///< since t = 0
    std::int64_t overlaps, row_step; ///< tallies and step at the last row
    PairProgress pair;
};

class Record {
public:
    Record(double order_cutoff, std::size_t rods) : cutoff_(order_cutoff), rods_(rods), thrust_(rods) {
        sums_.pair.half_box_time = -1.0;
    }

    /// Takes a sample now; the first one at t = 0 starts the means.
    void sample(const Simulation& simulation);
    TableRow row(const Simulation& simulation);
    std::vector<TrackPoint> track(const Simulation& simulation);

    /// How far the rods came along their headings at t = 0, mean, m.
    double mean_advance() const;
    const std::vector<RodProgress>& rods() const { return rods_; }
    const std::vector<RodThrust>& thrust() const { return thrust_; }
    const RecordSums& sums() const { return sums_; }
    const PressureSums& pressure_sums() const { return pressure_; }
    /// Mean from t = 0 on, N/m.
    PlaneTensor mean_pressure(const Simulation& simulation) const;
    void restore(const RecordSums& sums, const PressureSums& pressure, std::vector<RodProgress> rods,
                 std::vector<RodThrust> thrust);

private:
    void begin(const Simulation& simulation);
    void follow_rods(const Simulation& simulation);
    void follow_pair(const Simulation& simulation);

    double cutoff_;
    RecordSums sums_{};
    PressureSums pressure_{};
    std::vector<RodProgress> rods_;
    std::vector<RodThrust> thrust_; ///< a value a rod
};

} // namespace rodwake::granular
