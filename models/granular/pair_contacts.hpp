#pragma once
// Impulses between beads and rods that overlap at the end of a step.
//
// Two spheres that overlap met during the step: with r their distance vector and v their relative velocity
// (relative motion knows no gravity), |r - v back| = R1 + R2 gives how long ago. The impulse acts there and
// then, and both fly on with their new velocities for that time. Spheres that overlapped before the step,
// which other impulses leave behind, get theirs where they are. Without rebound nothing takes them apart
// again, and they would sink into each other a little with every impulse: those deeper than sweeps can mend
// are moved.

#include "bodies.hpp"
#include "kernels.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/granular/simulation.hpp"

#include <optional>
#include <span>
#include <vector>

namespace rodwake::granular {

/// The worst overlap of a step, for the guard.
struct WorstOverlap {
    double radii = 0.0; ///< depth over the smaller radius
    Pair pair{0, 0};
    double shift = 0.0; ///< no sphere was moved further, impulses aside, m
};

/// What the impulses of a step need to know of their surroundings.
struct PairSetting {
    ContactTable table;
    PeriodicBox box;
    double time_step, gravity;
};

class PairContacts {
public:
    explicit PairContacts(const PairSetting& setting) : setting_(setting) {}

    /// Sweeps over the overlapping pairs, which come in the order (first, second); adds to the tallies.
    /// Approaching pairs get an impulse; of the contacts of a rod with one bead or one other rod only the
    /// first to touch. A bed that settles is not moved apart: what is jammed at its start gives way by
    /// itself.
    WorstOverlap resolve(Bodies& bodies, std::span<const Pair> overlapping, Counters& tallies,
                         ThreadPool& team, bool settles = false);

private:
    /// Two spheres that overlap and approach.
    struct TouchingPair {
        Pair pair;
        double back;   ///< how long ago they touched, s
        double length; ///< of their distance vector then, m: R1 + R2, or less if they overlapped before
    };
    struct ContactBlock {
        std::vector<Pair> left; ///< pairs with a partner outside
        WorstOverlap worst;
        std::int64_t impulses = 0;
        PlaneTensor virial{};
    };
    struct RodContact {
        std::uint32_t first_rod, second_rod;
        TouchingPair meeting;
    };
    // Compiled for beads that are all equal and for others; what they share differs in bits.
    template<bool equal>
    WorstOverlap resolve_as(Bodies& bodies, std::span<const Pair> overlapping, Counters& tallies,
                            ThreadPool& team, bool settles);
    template<bool equal>
    std::optional<TouchingPair> meeting(const Bodies& bodies, const Pair& pair, WorstOverlap& worst) const;
    Vector3 apart(const Bodies& bodies, const Pair& pair) const;
    template<bool equal>
    void within_block(Bodies& bodies, std::span<const Pair> pairs, std::size_t end,
                      ContactBlock& block) const;
    template<bool equal>
    void one_by_one(Bodies& bodies, std::span<const Pair> pairs, WorstOverlap& worst, Counters& tallies);
    template<bool equal>
    void bead_bead(Bodies& bodies, const TouchingPair& meeting, PlaneTensor& virial) const;
    void unequal_beads(Bodies& bodies, const TouchingPair& meeting, PlaneTensor& virial) const;
    void bead_rod(Bodies& bodies, const TouchingPair& meeting, Counters& tallies) const;
    void rod_rod(Bodies& bodies, const TouchingPair& meeting, Counters& tallies) const;
    double move_apart(Bodies& bodies, std::span<const Pair> pairs) const;

    PairSetting setting_;
    std::vector<ContactBlock> blocks_;
    std::vector<RodContact> rod_contacts_;
};

} // namespace rodwake::granular
