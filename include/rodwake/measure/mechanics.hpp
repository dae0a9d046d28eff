#pragma once
// How rods drag the whole bed along, with how much inertia it moves, and how far their wakes reach.
//
//   0         = F - gamma M V             steady: M = n m Lx Ly, mass of the beads; V, velocity of their
//                                         centre of mass; F, force of the rods (or of a uniform body force)
//                                         on them; gamma = zeta/(n m), drag rate of the plates, 1/s
//   gamma     = sum_b |P_b| / (M sum_b D_b.e_b)   over blocks of time: P_b momentum handed over, e_b its
//                                         direction, D_b how far the bed came
//   m*        = gamma/(decay rate of V)   inertia over mass (drift_decay.hpp): beads that move have to spin
//   mu        = m* n m c_T^2              c_T, speed of transverse sound, which has that inertia too
//   xi        = mu/(zeta v) = m* c_T^2/(gamma v)
//                                         screening length (docs/theory.md, section 1), v the rod's speed
//                                         relative to the bed
//   Peclet    = L/xi                      drag over elasticity on the scale of the box (L: shorter side)
//
// So m* cancels if c_T and the decay rate gamma/m* are put together, c_T^2/((gamma/m*) v); with the drag of a
// steady push it does not. Without any m* xi is that of the bare mass, too short by m*.
//
// Only the push of a rod along its heading counts; across it none is expected. Valid once the bed drifts
// steadily, some 1/gamma after the start, and for drifts above what the plates' noise gives the bed: the
// error of the drift tells.

#include "rodwake/measure/drift_decay.hpp"
#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/statistics.hpp"

#include <optional>
#include <span>
#include <vector>

namespace rodwake::measure {

struct MechanicsOptions {
    double block = 5.0; ///< s

    bool operator==(const MechanicsOptions&) const = default;
};

class MechanicsAccumulator {
public:
    MechanicsAccumulator(const Layout& layout, const MechanicsOptions& options);

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    /// Centre of mass of the beads, unwrapped, s and m.
    struct Mark {
        double time = 0.0, x = 0.0, y = 0.0;
    };
    const Layout& layout() const { return layout_; }
    const MechanicsOptions& options() const { return options_; }
    std::span<const Mark> path() const { return path_; } ///< in every frame
    /// In the first frame of each block and in the last frame; a last block of less than half the length is
    /// part of the one before.
    std::vector<Mark> marks() const;

private:
    Layout layout_;
    MechanicsOptions options_;
    std::vector<Mark> path_;
};

/// What pushed the bed in a run; times rise.
struct RodPushes {
    std::vector<double> time;                 ///< s, from 0 on
    std::vector<double> impulse_x, impulse_y; ///< on the beads since t = 0, N s
    std::vector<double>
        advance; ///< of one rod along its heading since t = 0, m; empty: no rods, a steady body force alone
};

struct MechanicsResult {
    Estimate force;      ///< of the rods on the bed, N
    Estimate drift;      ///< of the bed along it, m/s
    Estimate drag_rate;  ///< gamma, 1/s
    Estimate speed;      ///< of the rod along its heading relative to the bed, m/s; count 0: no rod
    DriftDecay decay;    ///< of the bed's own drift; m* by it and drag_rate
    Estimate inertia;    ///< m* of xi: given or measured; count 0: none is known, xi is that of the bare mass
    Estimate screening;  ///< xi, m; count 0 without a speed of sound or a rod
    Estimate peclet;     ///< the same
    double before = 0.0; ///< how far the rod came before the first frame, the least of the runs, m
    double along = 0.0;  ///< how far while it was measured, the least of the runs, m
    /// The wake had a distance of min(xi, L/2) to build up in before it was measured, and as much while it
    /// was (xi unknown: L/2): a box holds a wake of half its side. Without rods: three times 1/gamma before.
    bool steady = false;
    double wanted = 0.0; ///< that distance, m
    std::size_t blocks = 0;
};

/// Whether an m* is good enough to be used: positive, its error known and at most a fifth of it.
bool usable_inertia(const Estimate& inertia);

/// m* by these runs alone; as `decay` and `drag_rate` of reduce.
DriftDecay measured_decay(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes);

/// `shear_speed` is c_T in m/s, count 0: not known; `inertia` is m*, absent: as measured, if it is usable.
/// Throws InputError for fewer than one block of frames or runs of different beds, RunError where tracks end
/// before the frames.
MechanicsResult reduce(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes,
                       const Estimate& shear_speed, const std::optional<Estimate>& inertia = std::nullopt);

} // namespace rodwake::measure
