#pragma once
// Initial-value problems y' = f(t, y), or M y' = f(t, y) with a diagonal M of ones and zeros: problem, method
// and result are three types.
// This part is the only code that includes SUNDIALS; nothing of SUNDIALS appears in its headers.

#include "rodwake/integrate/method.hpp"

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rodwake::integrate {

using State = std::span<const double>;

enum class Crossing { rising, falling, any };

struct Step;

/// A root to be found: the solver reports each time at which value(t, y) leaves its sign in the given
/// direction: it crosses zero, or reaches it, as at the first zero of a plateau. An event that is zero at the
/// start waits until it has left zero, and nothing crosses from zero. The time reported is the later end of a
/// bracket a few roundings wide: the value has its new sign there. Starting there again, an event with
/// Crossing::any does not return to its root: within a thousand roundings of the start it does not fire.
///
/// Found are, on the solution as the method of order q interpolates it, all roots of an event that
/// - is a polynomial of t of degree q or less in the step, such as a component of y;
/// - or has its roots at least a third of a step apart, however rough it is.
/// Other smooth events are sampled until a polynomial predicts them: a dip is found if a step, halved where
/// the event varies, shows it. A pulse between samples that are flat is not: give max_step, an output time or
/// candidate_time there. A touch of zero without change of sign may or may not be found. Where an event
/// varies much faster than the state, steps are shortened; noise that no 65536th of a step resolves fails the
/// solve.
struct Event {
    std::string name;
    std::function<double(double t, State y)> value;
    Crossing crossing = Crossing::any;
    bool terminal = false; ///< stop there; the final time and state are those of the root
    /// If given, this names a time inside the step at which the value may have changed sign; the solver looks
    /// there too. Called once a step.
    std::function<std::optional<double>(const Step&)> candidate_time = nullptr;
    /// False: roots hide inside a step at candidate_time alone, or where other events have theirs. Saves the
    /// samples: q of each event in each step, and with erk three to eight right-hand sides.
    bool sampled = true;
};

/// y' = rhs(t, y), y(start_time) = initial_state. Functions may throw: the solve then fails with the
/// exception's text. A right-hand side that is not finite makes the solver try a shorter step first. It is
/// never called beyond the last output time.
struct OdeProblem {
    std::vector<double> initial_state;
    double start_time = 0.0;
    std::function<void(double t, State y, std::span<double> ydot)> rhs;
    /// d rhs_i / d y_j into J(i, j), all zero on entry; used by BDF. Empty: difference quotients.
    std::function<void(double t, State y, Eigen::Ref<Eigen::MatrixXd> jacobian)> jacobian;
    std::vector<Event> events;
    /// Name of component i in messages ("rods[3].theta"). Empty: "y[i]".
    std::function<std::string(std::size_t)> component_name;
    /// The tolerance of component i is rtol min(|y_i|, relative_cap) + atol, at least a few ulp of y_i; a
    /// step is accepted if the squares of the errors over the tolerances add up to at most 1. Finite for
    /// coordinates whose origin means nothing: the scale on which they matter, so that the result does not
    /// depend on where the origin is. Algebraic components are not capped.
    double relative_cap = std::numeric_limits<double>::infinity();
    /// Longest step worth taking from (t, y), > 0; empty: none. For right-hand sides that are quiet until
    /// something happens: error control sees only the ends and stages of a step, and can step over it. The
    /// solver may lag one step behind.
    std::function<double(double t, State y)> step_limit = nullptr;
    /// algebraic[i]: row i is the constraint 0 = rhs_i, not y_i' = rhs_i, and the initial y_i only a guess.
    /// The constraints must determine these components (index 1). They have no part in the error test. As
    /// long as the state, or empty; needs method bdf (IDAS).
    std::vector<bool> algebraic = {};
    /// Puts y back on the manifold on which the exact solution lies and returns how far off it was; see
    /// Statistics::drift. Called after each step: bdf by CVODES' projection, erk between steps; with
    /// algebraic components the distance is recorded and the state left alone. Not with adams, nor with
    /// sensitivities. Must not throw.
    std::function<double(std::span<double> y)> project = nullptr;
};

/// State at the end of an accepted internal step.
struct Step {
    double time_before, time;
    State state_before, state;
};

struct Statistics {
    long steps = 0, rhs_evaluations = 0, jacobian_evaluations = 0;
    long error_test_failures = 0, convergence_failures = 0, event_evaluations = 0;
    double drift = 0.0; ///< the largest distance that OdeProblem::project returned

    Statistics& operator+=(const Statistics& other); ///< of the drifts the larger
};

/// A restart point: solving on from here gives the same bits as the uninterrupted run.
struct Segment {
    double time;
    State state;
    std::span<const std::vector<double>> outputs; ///< states at the output times at or before this point
    Statistics statistics;
};

struct OdeOptions {
    Method method = Method::adams;
    double rtol = 1e-8;         ///< relative tolerance of the local error, each component; 1e-13 to 0.1
    double atol = 1e-10;        ///< absolute tolerance, unit of the component; > 0
    long max_steps = 1'000'000; ///< ceiling on internal steps of the whole solve
    double initial_step = 0.0;  ///< of each segment; 0: chosen by the solver
    double max_step = 0.0;      ///< 0: none
    /// The method's history is discarded every so many steps, interrupted or not, so that a solve resumed
    /// from such a point repeats the uninterrupted one bit for bit.
    long segment_steps = 20000;
    // Exceptions of these three reach the caller of solve().
    /// Polled once a step; true ends the solve as `interrupted`.
    std::function<bool()> stop_requested;
    /// After each accepted step. A terminal event cuts its step short.
    std::function<void(const Step&)> on_step;
    /// After each completed segment but the last.
    std::function<void(const Segment&)> on_segment;
};

enum class Termination { reached_end, stopped_at_event, interrupted, failed };
/// Names for messages and files: "reached_end".
const char* to_string(Termination termination);

/// How a solve ended. For `failed`, everything a user needs to act on it.
struct Status {
    struct Component {
        std::string name;
        double weighted_error; ///< estimated local error over the tolerance; above 1 means not met
    };
    Termination termination = Termination::reached_end;
    double reached = 0.0, wanted = 0.0; ///< time
    double step = 0.0;                  ///< last step size
    int order = 0;                      ///< last order
    std::string flag;                   ///< the solver's name for the failure, "CV_ERR_FAILURE"
    std::vector<Component> worst; ///< worst first, at most ten; none if a function of the problem failed
    std::string cause;            ///< likely cause
    std::string advice;           ///< a key to try

    bool ok() const { return termination != Termination::failed; }
    /// All of it in words, in one line.
    std::string message() const;
};

struct EventHit {
    std::size_t event; ///< index into OdeProblem::events
    double time;
    std::vector<double> state;
};

struct Solution {
    std::vector<double> times;               ///< the requested times that were reached, exactly as requested
    std::vector<std::vector<double>> states; ///< states[k] at times[k]
    std::vector<EventHit> hits;              ///< in order of time
    double final_time = 0.0; ///< where it ended: last output time, terminal event, or point of failure
    std::vector<double> final_state;
    Status status;
    Statistics statistics;
};

/// Integrates to the last of output_times (at least one, increasing, >= start_time). The steps, and so the
/// final state, do not depend on the output times before the last; sampled events are looked at there too.
/// Never throws for a failure of the solve: see Solution::status. Throws InputError for a malformed problem
/// (sizes, tolerances, times, non-finite initial state). Global accuracy: each step's local errors are held
/// to the tolerance of OdeProblem::relative_cap; on the reference trajectories the result's error was at most
/// 83 times rtol for each method (studies/reports/rods.md), and where trajectories diverge it grows as they
/// do. Thread-safe: each call owns its SUNContext.
Solution solve(const OdeProblem& problem, const OdeOptions& options, std::span<const double> output_times);

/// Names for messages and files: "bdf", "adams", "erk".
std::string to_string(Method method);

} // namespace rodwake::integrate
