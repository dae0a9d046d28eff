#include "outcome_text.hpp"

#include <fmt/format.h>

namespace rodwake::rods {

void describe(RodOutcome& outcome, std::size_t rods, const integrate::Status& status) {
    if (!status.ok())
        outcome.reason = "the integration stopped early";
    else if (status.termination == integrate::Termination::interrupted)
        outcome.reason = fmt::format("interrupted at t = {:.6g}", outcome.time);
    else if (rods < 2)
        outcome.reason = "a single rod has no partner";
    else if (rods > most_followed_rods && outcome.ending != Ending::contact)
        outcome.reason =
            fmt::format("of more than {} rods no pair is told apart; rods {} and {} came "
                        "closest, {:.6g} apart",
                        most_followed_rods, outcome.pair.first, outcome.pair.second, outcome.min_separation);
    else if (outcome.ending == Ending::contact && outcome.time == 0.0)
        outcome.reason = fmt::format("rods {} and {} start {:.6g} apart, within the contact distance",
                                     outcome.pair.first, outcome.pair.second, outcome.pair.distance);
    else if (outcome.ending == Ending::contact)
        outcome.reason = fmt::format("rods {} and {} came within {:.6g} at t = {:.6g}", outcome.pair.first,
                                     outcome.pair.second, outcome.pair.distance, outcome.time);
    else if (outcome.ending == Ending::pursuit)
        outcome.reason = fmt::format("rods {} and {} share a heading and keep their distance of {:.6g}",
                                     outcome.pair.first, outcome.pair.second, outcome.pair.distance);
    else if (outcome.ending == Ending::escape)
        outcome.reason = fmt::format("all rods part; rods {} and {} came closest, {:.6g} apart",
                                     outcome.pair.first, outcome.pair.second, outcome.min_separation);
    else
        outcome.reason =
            fmt::format("neither contact, locked pursuit nor parting by t = {:.6g}; a longer t_end may "
                        "decide",
                        outcome.time);
}

} // namespace rodwake::rods
