#pragma once
// A bound of the error of a pair's solution, step by step, and what it says of the outcome. docs/physics.md,
// section 7.

#include "pair_jets.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <array>
#include <optional>
#include <vector>

namespace rodwake::rods {

/// A solution at the ends of its steps.
struct PairTrack {
    std::vector<double> times;
    std::vector<std::array<double, 6>> states; ///< as in model.hpp

    void add(double time, integrate::State y);
};

struct Interval {
    double low, high;
};

/// What is known of an encounter that decides its ending.
struct EncounterBounds {
    enum class Contact { none, certain, unknown } contact = Contact::unknown;
    double x = 0.0, y = 0.0, heading[2] = {}; ///< R_0 - R_1 at the end
    double place_error = 0.0, heading_error[2] = {};
    Interval late_least{}, late_most{}, late_turning{}; ///< LatePart
};

/// Whether two rods so far apart can follow each other.
using Feels = std::function<bool(double distance)>;
/// The ending that all encounters within the bounds have; nothing: they have more than one.
std::optional<Ending> certain_ending(const EncounterBounds& bounds, const EndingCriteria& criteria,
                                     const Feels& feels);

/// Memory that is used again from pair to pair.
struct ProofSpace {
    PairJets ends, inner, few;
};

/// Pairs about one: half the widths of R_0 - R_1 and the headings at the start, and of the couplings.
struct PairSpread {
    std::array<double, 4> start{};
    Couplings couplings{};
};

/// Of the exact solution, if the error can be bounded; `contact`: the track ends in contact.
std::optional<EncounterBounds> proved_bounds(const PairProblem& pair, const PairTrack& track, bool contact,
                                             const EndingCriteria& criteria, ProofSpace& space,
                                             const PairSpread& spread = {});

} // namespace rodwake::rods
