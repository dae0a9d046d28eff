#pragma once
// Decides the outcome of an encounter from bounds on its state. docs/numerics.md, section 4.

#include "rodwake/rods/simulate.hpp"

#include <functional>
#include <optional>

namespace rodwake::rods {

struct Enclosure {
    double low, high;
};

/// What is known of an encounter that decides its ending.
struct EncounterBounds {
    enum class Contact { none, certain, unknown } contact = Contact::unknown;
    double x = 0.0, y = 0.0, heading[2] = {}; ///< R_0 - R_1 at the end
    double place_error = 0.0, heading_error[2] = {};
    Enclosure late_least{}, late_most{}, late_turning{}; ///< TailWindow
};

/// Whether two rods so far apart can follow each other.
using Feels = std::function<bool(double distance)>;
/// The ending that all encounters within the bounds have; nothing: they have more than one.
std::optional<Ending> certain_ending(const EncounterBounds& bounds, const EndingCriteria& criteria,
                                     const Feels& feels);

/// The ending of all pairs together, as classify_outcome decides it; nothing: it may be another.
std::optional<Ending> together(std::span<const std::optional<Ending>> pairs);

} // namespace rodwake::rods
