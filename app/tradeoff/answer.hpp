#pragma once
// What a setting computes, and how far two of them are apart.

#include "rodwake/app/tradeoff.hpp"
#include "rodwake/core/encounter.hpp"

namespace rodwake::app {

/// A run, reduced units.
struct Encounter {
    bool solved = false; ///< if not, the rest means nothing
    Ending ending = Ending::undecided;
    double time = 0.0;                     ///< of contact, else the end
    std::vector<double> final_state;       ///< of rods.csv; of a scan: separation and turns
    std::vector<std::vector<double>> path; ///< at the output times up to the end; of a scan: none
};

struct Answer {
    std::vector<Encounter> encounters;
    long rhs_evaluations = 0;
    std::string failure; ///< of a run; empty: none
};

inline constexpr const char* took_too_long = "took too long";

/// The errors of one answer against the other, as ErrorKind tells.
Errors errors_between(const Answer& one, const Answer& other);

} // namespace rodwake::app
