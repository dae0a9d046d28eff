#pragma once
// One run of N rods: problem, options, result. The result of a failed solve is a value: see
// RodResult::solution.status.
//
// Error of states and contact times, 12 reference cases (build/dev/tests/test_rods; "[long]"): at rtol 1e-11
// BDF 8.3e-10, Adams 8.2e-10, ERK 6.5e-10; at rtol 1e-4 to 1e-11 at most 83 rtol.
//
// Degenerate input:
//   no rods; t_end or contact_distance <= 0 or NaN              InputError
//   a place or heading that is not finite, times out of order   InputError
//   an illegal medium (eta <= -1, xi = 0)                       InputError
//   coincident rods, without or with a contact distance         InputError; contact at 0
//   rods that meet, without a contact distance                  failed, advised to set one
//   bodies that overlap at the start                            InputError
//   a coupling that is NaN or infinite                          failed, undecided
//   one rod; no medium; no coupling                             straight walks
//   xi = 1e30 (alpha -> 0), eta -> -1, eta = 1e12               runs
//   xi = 1e-30 (alpha -> infinity)                              straight walks

#include "rodwake/core/periodic.hpp"
#include "rodwake/rods/form.hpp"
#include "rodwake/rods/model.hpp"
#include "rodwake/rods/separation_record.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::rods {

/// How the wakes of 8 rods or more are added up on the plane in the exact field (elastic/mutual_wakes.hpp).
struct InteractionOptions {
    elastic::Accuracy accuracy = elastic::Accuracy::full;
    /// Far wakes are summed on meshes where that is cheaper, with errors of each theta' below this, rad mu
    /// v0/f. Errors change at random as rods move, and steps get short where such a change times a step is
    /// above the solver's tolerance. 0: pair by pair.
    double turning_tolerance = 0.0;
    std::size_t threads = 1; ///< the bits do not depend on it
};
using WakeSums [[deprecated("they are InteractionOptions")]] = InteractionOptions;

/// Reduced units: lengths f/mu, times f/(mu v0).
struct RodProblem {
    std::optional<elastic::Medium> medium; ///< absent: rods walk straight
    Couplings couplings;
    std::vector<Pose> rods;
    double t_end = 0.0;
    std::vector<double> output_times;       ///< increasing, in [0, t_end]; t_end is added if missing
    std::optional<double> contact_distance; ///< stop when two rods are this close, also at the start
    std::optional<PeriodicBox> box = {};    ///< axes x and y; absent: infinite plane
    /// How the wakes of this medium in this domain are worked out; absent: exactly.
    std::shared_ptr<const elastic::WakeField> field = nullptr;
    InteractionOptions sums = {};
    Rows rows = {}; ///< of a crystal that turns each rod, with or without a medium
    RodBodies bodies = {};
    bool goes_on = false; ///< from the state of another run: then bodies may overlap at the start
};

/// Sums whose errors keep to sums.turning_tolerance T. With d eps the error of the strain and
/// d A, d B those of the polar vectors
///
///   |d theta'| <= |kappa| |d eps|/sqrt(2) + |gamma1| |d A| + |gamma2| |d B|
///
/// (only the traceless part of eps turns a rod, and (eps_xy, (eps_yy - eps_xx)/2) is at most |eps|/sqrt(2)
/// long), so |d eps| < sqrt(2) T/|kappa| and |d A|, |d B| < T/(|gamma1| + |gamma2|) are enough; with both
/// kinds of coupling each gets T/2.
elastic::MutualWakesOptions sum_options(const Couplings& couplings, const InteractionOptions& sums);

/// The wakes a problem's rods move in; none without a medium. Throws InputError if problem.field is of
/// another medium or box, or problem.sums asks for what only the exact field on the plane has.
std::shared_ptr<const elastic::WakeField> wakes_of(const RodProblem& problem);
/// The equations of motion of a problem.
RodModel model_of(const RodProblem& problem);

/// Where a run can be taken up again; going on from here repeats the uninterrupted run to the bit.
struct RodCheckpoint {
    double time = 0.0;
    std::vector<double> state;                ///< in the form of the run
    std::vector<double> headings;             ///< of each rod, with all its turns
    std::vector<double> times;                ///< output times so far
    std::vector<std::vector<double>> outputs; ///< poses at these times
    SeparationRecord record;
    integrate::Statistics statistics;
};

struct RodOptions {
    integrate::OdeOptions
        ode; ///< atol counts up to rtol/10: coordinates matter on the scale of f/mu and a radian
    Formulation form = Formulation::angle; ///< director: not with adams; dae: with bdf only
    EndingCriteria criteria;
    /// Of rods with bodies, in form angle: wakes are held over steps longer than those of the contacts
    /// (suits_held_wakes).
    bool held_wakes = false;
    std::function<void(const RodCheckpoint&)> on_checkpoint; ///< at the solver's segment ends
    std::function<void(const RodCheckpoint&)> on_end;        ///< of a run that reaches t_end
    std::optional<RodCheckpoint> resume_from;                ///< of the same problem and options
};

/// A checkpoint of the same problem with an earlier t_end or other output times, as one of this problem. The
/// solver starts anew there, so the run agrees with an uninterrupted one within the tolerance. Nothing if the
/// run must start at 0: an output time before the checkpoint has no row, or the checkpoint lies in the last
/// part of this run, over which separations are followed.
std::optional<RodCheckpoint> carried_over(RodCheckpoint from, const RodProblem& problem,
                                          const EndingCriteria& criteria);

struct RodOutcome {
    Ending ending = Ending::undecided;
    double time = 0.0; ///< of contact, else the time reached
    Separation pair;   ///< the pair it is about: in contact, in pursuit, else the closest at any time
    double min_separation = 0.0; ///< smallest separation of any pair at any time; infinite for a single rod
    double min_separation_time = 0.0; ///< when
    std::vector<double> turn;         ///< theta(end) - theta(0) of each rod, rad
    /// Distance of the orbit to which the rods come, or the last distance of a pursuit; NaN: neither.
    double separation = std::numeric_limits<double>::quiet_NaN();
    /// Turning rate of an orbit, + counterclockwise, rad mu v0/f; NaN: no orbit.
    double omega = std::numeric_limits<double>::quiet_NaN();
    /// A pursuit of two rods in their steady wakes has these: whether the separation still grows at the end,
    /// and whether rods in line at this separation are stable. Rods that start exactly in line stay in line
    /// though they may be unstable there.
    std::optional<bool> grows = {}, stable = {};
    /// Smallest gap between the bodies of two rods at any time, below 0: overlap, f/mu; NaN: no bodies.
    double min_gap = std::numeric_limits<double>::quiet_NaN();
    double min_gap_time = 0.0; ///< when
    std::string failed; ///< of an undecided outcome: the criteria that two rods fail, with their numbers
    std::string reason; ///< in words, with the numbers
    Certificate certificate = Certificate::open; ///< by simulate_certified (certificate.hpp)
};

struct RodResult {
    integrate::Solution solution; ///< states as in model.hpp, whatever the form
    RodOutcome outcome;
    SeparationRecord record = {}; ///< separations from which the outcome was decided
};

/// Runs to t_end or to contact; rods that start within the contact distance are in contact at 0. Throws
/// InputError for an ill-posed problem: no rods, coincident rods without a contact distance, times out of
/// order. Deterministic; thread-safe.
RodResult simulate(const RodProblem& problem, const RodOptions& options);

/// OdeProblem::step_limit of rods that interact: encounter_step, and near eta = -1 wake_step.
std::function<double(double t, integrate::State y)> step_limit(const RodProblem& problem);

/// The initial-value problem by itself, for those who want to integrate it their own way. Steps are limited
/// by step_limit, so that no encounter is stepped over however quiet the field before it. Refuses rods
/// that start in contact, which the event could not find.
integrate::OdeProblem to_ode(const RodProblem& problem);
/// In another form. Director: with Jacobian and projection, for bdf and erk; dae: for bdf (IDAS), Jacobian by
/// difference quotients.
integrate::OdeProblem to_ode(const RodProblem& problem, Formulation form);

/// The state of rods with these poses (layout of model.hpp). lambda is 0; to_ode sets the one that belongs to
/// it.
std::vector<double> to_form(Formulation form, integrate::State poses);
/// The poses of a state; each heading the one nearest to that in `near` (one a rod), of which it may be any
/// number of turns. A director need not have length 1.
std::vector<double> to_poses(Formulation form, integrate::State state, std::span<const double> near);

// Which integrator suits a problem, for method = "auto".

/// Rods are not stiff until a heading relaxes much faster than a rod walks past its neighbour. With k the
/// largest |d theta_a'/d theta_b| at the start and r the smallest separation, k r (v0 = 1) is that ratio:
/// above 30 BDF, below explicit Runge-Kutta. Measured at both ends in studies/reports/rods.md (side by side,
/// 5 apart: 0.5 at kappa = 100, 46 at kappa = 1e4). Of more than most_followed_rods rods always explicit
/// Runge-Kutta: Newton's dense matrix of 3 N x 3 N costs more than shorter steps.
/// Up to 30 rods with bodies whose stall_overlap is below 0.02 take BDF: explicit steps are bounded by the
/// contacts, not by the error (at 1e-3 two rods that meet take 15000 steps, BDF 880).
integrate::Method suitable_method(const RodProblem& problem);

/// Of more than most_followed_rods rods with bodies in each other's wakes, where contacts take ten steps and
/// more while the wakes hardly change: they are evaluated twice a long step H of second order. H follows from
/// an estimate of its local error, below the tolerance, and is at most encounter_step.
bool suits_held_wakes(const RodProblem& problem);

/// k r of the above; 0 for rods that do not interact.
double stiffness(const RodProblem& problem);

} // namespace rodwake::rods
