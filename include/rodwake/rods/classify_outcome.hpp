#pragma once
// What every way of integrating rods begins and ends with: a problem that can be posed, and the outcome of
// its solution. For integrators of other models than rods/model.hpp, and for other right-hand sides.

#include "rodwake/rods/body.hpp"
#include "rodwake/rods/simulate.hpp"

#include <vector>

namespace rodwake::rods {

/// Throws InputError for an ill-posed problem, and for rods that start in contact.
void validate(const RodProblem& problem);

/// Rods that start within the contact distance, also in one place, are in contact at time 0, and the run is
/// over; others: nothing. Throws InputError as validate does for all but the separation.
std::optional<RodResult> contact_at_start(const RodProblem& problem);

/// Whether the wake of a rod can turn another one, `distance` behind it, by `angle` in this time: by the
/// bounds of elastic/wake_bound.hpp, which are a few times the field. Rods that cannot do not interact.
bool reaches(const elastic::Medium& medium, const Couplings& couplings, double distance, double time,
             double angle);

/// Those of the problem, and t_end.
std::vector<double> output_times(const RodProblem& problem);

/// What the rods of a solution turn by: in each other's steady wakes alone two of them may end in an orbit.
enum class TurnedBy { steady_wakes, other };

/// The outcome of a solution by poses. `rates`: of the final state; `interacting`: rods that do not cannot
/// pursue each other.
RodOutcome classify_outcome(const RodProblem& problem, bool interacting, const StateRates& rates,
                            const integrate::Solution& solution, const SeparationRecord& record,
                            const EndingCriteria& criteria, TurnedBy turned_by = TurnedBy::other);

/// Longest step from a state in which a touch of bodies is seen (BodyForces::step_limit); unseen ones shift
/// few rods by less than any tolerance, and a crowd by little. Infinite without bodies.
double body_step(const BodyForces& bodies, integrate::State y);

/// As simulate, form angle, with `rates` instead of those of rods/model.hpp: of places and headings by the
/// state, in its layout, finite where rods meet: they change over `width`, f/mu, below which steps need not
/// go on account of rods that are near. No Jacobian: difference quotients.
RodResult simulate_rates(const RodProblem& problem, const StateRates& rates, double width,
                         const RodOptions& options);

/// A solve that fails with two rods nearly in one place failed because their fields are singular there: the
/// status then says so.
void explain_collision(integrate::Solution& solution, Box box);

/// A motion that is known at some times, whoever worked it out: rods with a turning law of their own, for
/// one. Reduced units: lengths f/mu, times f/(mu v0). Rods walk at speed 1 along their headings, which count
/// turns. Between rows places and headings follow the cubic through them with these rates.
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
