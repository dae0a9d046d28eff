#pragma once
// Impulses between beads and rods that overlap.

#include "bodies.hpp"
#include "kernels.hpp"
#include "rodwake/granular/simulation.hpp"

#include <span>

namespace rodwake::granular {

/// The worst overlap of a step, for the guard.
struct WorstOverlap {
    double radii = 0.0; ///< depth over the smaller radius
    Pair pair{0, 0};
};

class PairContacts {
public:
    PairContacts(const ContactTable& table, double box) : table_(table), box_(box) {}

    /// One sweep over the overlapping pairs in their order; adds to the tallies. Approaching pairs get an
    /// impulse; of the contacts of a rod with one bead or one other rod only the deepest.
    WorstOverlap resolve(Bodies& bodies, std::span<const Pair> overlapping, Tallies& tallies);

private:
    struct Touch {
        Vector3 normal; ///< from second to first
        double depth;
    };
    Touch touch(const Bodies& bodies, const Pair& pair) const;
    void bead_bead(Bodies& bodies, const Pair& pair, const Touch& touch, Tallies& tallies) const;
    void bead_rod(Bodies& bodies, const Pair& pair, const Touch& touch, Tallies& tallies) const;
    void rod_rod(Bodies& bodies, const Pair& pair, const Touch& touch, Tallies& tallies) const;
    void keep_deepest(const Bodies& bodies, const Pair& pair, const Touch& touch);

    ContactTable table_;
    double box_;
    struct RodContact {
        std::uint32_t first_rod, second_rod;
        Pair pair;
        Touch touch;
    };
    std::vector<RodContact> rod_contacts_;
};

} // namespace rodwake::granular
