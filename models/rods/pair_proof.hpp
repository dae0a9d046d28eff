#pragma once
// A bound of the error of a pair's solution, step by step, and of its outcome. docs/numerics.md,
// section 4. Reduced units; of two rods on the infinite plane, eta >= 0. Rounding is allowed for by 32 ulp of
// the parts in each defect, not enclosed.

#include "pair_decision.hpp"
#include "pair_jets.hpp"
#include "pair_pieces.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <array>
#include <optional>
#include <vector>

namespace rodwake::rods {

/// A solution at the ends of its steps.
struct StepTrack {
    std::vector<double> times;
    std::vector<std::array<double, 6>> states; ///< as in model.hpp

    void add(double time, integrate::State y);
};

/// Memory that is reused from pair to pair.
struct ProofSpace {
    PairJets ends;
    std::vector<ProofPiece> pieces;
    std::size_t used = 0; ///< of them
    std::vector<std::size_t> which;
};

/// A box of pairs: half widths of R_0 - R_1 and the headings at the start, and of the couplings.
struct PairSpread {
    std::array<double, 4> start{};
    Couplings couplings{};
};

/// Bounds of the exact solution, if the error can be bounded. `contact`: the track ends in contact.
std::optional<EncounterBounds> proved_bounds(const PairProblem& pair, const StepTrack& track, bool contact,
                                             const EndingCriteria& criteria, ProofSpace& space,
                                             const PairSpread& spread = {});

} // namespace rodwake::rods
