#pragma once
// What is kept of a run while it goes on: running means, one row of numbers at an interval, the rods' tracks.
// Long runs need not store frames.

#include "rodwake/core/record.hpp"
#include "rodwake/granular/simulation.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace rodwake::granular {

/// When a row of table.csv and tracks.csv was written.
struct RowTime {
    double t;

    static constexpr auto fields() {
        return std::tuple{field("t", &RowTime::t, {"s", "time; the rods are held before 0"})};
    }
};

/// One row of table.csv.
struct TableRow : RowTime {
    double energy, kinetic, T_xy, T_z, psi6, contacts, floor_impulse, lid_impulse, max_overlap, p_xx, p_xy,
        p_yy;

    static constexpr auto fields() {
        using R = TableRow;
        return std::tuple_cat(
            RowTime::fields(),
            std::tuple{
                field("energy", &R::energy, {"J", "kinetic and potential energy of beads and rods"}),
                field("kinetic", &R::kinetic, {"J", "kinetic energy of beads and rods"}),
                field("T_xy", &R::T_xy,
                      {"m^2/s^2", "(var vx + var vy)/2 of the beads, mean since the row before"}),
                field("T_z", &R::T_z, {"m^2/s^2", "var vz of the beads, mean since the row before"}),
                field("psi6", &R::psi6,
                      {"1", "|mean over the beads of psi6|, neighbours nearer than granular.order_cutoff"}),
                field("contacts", &R::contacts, {"1", "overlapping pairs a step, mean since the row before"}),
                field("floor_impulse", &R::floor_impulse,
                      {"N s", "upward momentum from the floor since the start"}),
                field("lid_impulse", &R::lid_impulse,
                      {"N s", "upward momentum from the lid since the start; negative"}),
                field("max_overlap", &R::max_overlap,
                      {"a", "largest overlap since the start, of the smaller radius"}),
                field("p_xx", &R::p_xx,
                      {"N/m",
                       "pressure along x in the plane, mean since the row before; in the first row the "
                       "kinetic part"}),
                field("p_xy", &R::p_xy, {"N/m", "shear part of the pressure tensor, the same"}),
                field("p_yy", &R::p_yy, {"N/m", "pressure along y, the same"})});
    }
};
static_assert(undescribed_members<TableRow>() == 0, "a column has its line in fields()");

/// Where a rod is in a row of tracks.csv.
struct TrackPoint {
    double x, y, z, heading, pitch, speed, impulse_on_beads;

    static constexpr auto fields() {
        using R = TrackPoint;
        return std::tuple{
            field("x", &R::x, {"m", "centre of mass of the rod, unwrapped"}),
            field("y", &R::y, {"m", "centre of mass of the rod, unwrapped"}),
            field("z", &R::z, {"m", "height of the centre of mass of the rod"}),
            field("theta", &R::heading, {"rad", "heading of the thin end from +x, without jumps"}),
            field("pitch", &R::pitch, {"rad", "angle of the axis to the horizontal"}),
            field("speed", &R::speed,
                  {"m/s", "along the heading, thin end first positive, mean since the row before"}),
            field("pushed", &R::impulse_on_beads,
                  {"N s", "momentum given to the beads along the heading since t = 0"})};
    }
};
static_assert(undescribed_members<TrackPoint>() == 0, "a column has its line in fields()");

/// How far a rod came, forward along its own heading, since t = 0.
struct RodProgress {
    double x0, y0, heading0;                   ///< at t = 0
    double x, y, heading;                      ///< at the last sample; heading without jumps
    double travelled;                          ///< integral of velocity along the heading, m
    std::array<double, 2> impulse_on_beads_at; ///< in-plane Counters::impulse_on_beads at the last sample
    double
        impulse_on_beads; ///< momentum given to the beads along the heading of each moment since t = 0, N s
    double row_travelled; ///< at the last row
};

/// Momentum that a rod got from the plates along the heading of each moment since t = 0. Over the time that
/// is its thrust: of a rod that walks freely and steadily as much as its force on the beads, of a lone one
/// zero.
struct RodThrust {
    std::array<double, 2> impulse_at; ///< in-plane Counters::impulse_from_plates at the last sample
    double impulse;                   ///< N s
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

/// Two rods: the change of their separation across their mean first heading (PairFrame), outwards positive.
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
    /// The sums over samples of each kind since t = 0; empty if there is one kind.
    const std::vector<SampleSums>& kinds() const { return kinds_; }
    /// Mean from t = 0 on, N/m.
    PlaneTensor mean_pressure(const Simulation& simulation) const;
    void restore(const RecordSums& sums, const PressureSums& pressure, std::vector<RodProgress> rods,
                 std::vector<RodThrust> thrust, std::vector<SampleSums> kinds);

private:
    void follow_rods(const Simulation& simulation);
    void follow_pair(const Simulation& simulation);

    double cutoff_;
    RecordSums sums_{};
    PressureSums pressure_{};
    std::vector<RodProgress> rods_;
    std::vector<RodThrust> thrust_; ///< a value a rod
    std::vector<SampleSums> kinds_;
};

} // namespace rodwake::granular
