#pragma once
// The outcome of a motion that is known at some times, whoever worked it out: rods with a turning law of
// their own, for one.

#include "rodwake/rods/simulate.hpp"

#include <optional>
#include <vector>

namespace rodwake::rods {

/// Rods that walk at speed 1 along their headings, which count turns. Between rows places and headings follow
/// the cubic through them with these rates.
struct RodTrack {
    std::vector<double> times;                ///< rising, two or more
    std::vector<std::vector<double>> states;  ///< at each time, as in model.hpp
    std::vector<std::vector<double>> turning; ///< at each time theta' of each rod
};

/// What a run is said to end with that goes the same way: contact at its first time, else by the last row and
/// the last part. `interacting`: rods that do not cannot pursue each other. The pair in contact is put at its
/// distance. Throws InputError for rods that do not walk at speed 1: their unit of length or time is another.
RodOutcome outcome_of(const RodTrack& track, std::optional<double> contact_distance, Box box,
                      bool interacting, const EndingCriteria& criteria = {});

} // namespace rodwake::rods
