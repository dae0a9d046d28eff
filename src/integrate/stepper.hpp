#pragma once
// One internal step at a time, whatever integrator takes it: all that solve() needs to know of one.

#include "rodwake/integrate/ode.hpp"
#include "user_functions.hpp"

#include <limits>
#include <memory>

namespace rodwake::integrate {

class Stepper {
public:
    Stepper(UserFunctions& calls, const OdeOptions& options, double end_time);
    Stepper(const Stepper&) = delete;
    Stepper& operator=(const Stepper&) = delete;
    virtual ~Stepper() = default;

    /// Discards all history: what follows depends on (t, y), the options and the end time alone.
    virtual void start(double t, State y) = 0;
    /// Takes one step, not beyond the end time. False if it failed: see flag_name().
    virtual bool advance() = 0;
    /// The solution at a time within the last step, with the accuracy of the method.
    virtual void interpolate(double t, std::span<double> y) = 0;
    /// For the step to come only. Infinity: any.
    void limit_next_step(double longest) { next_step_limit_ = longest; }
    /// dy/dp at a time within the last step, if the problem has parameters and the integrator can.
    virtual Eigen::MatrixXd sensitivities(double t);

    virtual int order() const = 0;
    /// The solver's own text about its last failure.
    const std::string& solver_text() const { return solver_text_; }
    /// After advance() failed.
    StepFailure failure() const;
    /// "CV", "IDA", "ARK" or "ERK".
    virtual std::string flag_prefix() const = 0;
    /// Estimated local error times error weight (1 / tolerance) of each component in the step tried last;
    /// empty when no step has been tried.
    virtual std::vector<double> weighted_errors() const = 0;
    /// The integrator's own counts since construction: steps, failures, Jacobians.
    Statistics counts() const;

    Step step() const { return {time_before_, time_, state_before(), state()}; }
    double time_before() const { return time_before_; }
    double time() const { return time_; }
    virtual State state_before() const = 0;
    virtual State state() const = 0;

protected:
    /// Counts since start().
    virtual Statistics segment_counts() const = 0;
    /// "CV_ERR_FAILURE", of the last step.
    virtual std::string flag_name() const = 0;
    /// The initial step to ask for at t; 0: the solver's choice.
    double initial_step(double t) const;
    /// The longest step to take from state_before(), where a step begins; 0: no limit.
    double longest_step() const;
    /// The shortest step worth trying at t: shorter ones may not change t.
    static double shortest_step(double t);

    UserFunctions& calls_;
    const OdeOptions& options_;
    const double end_time_;
    double time_before_ = 0.0, time_ = 0.0;
    double next_step_limit_ = std::numeric_limits<double>::infinity();
    Statistics earlier_; ///< counts of the integrators of earlier segments
    std::string solver_text_;
};

std::unique_ptr<Stepper> make_cvode_stepper(UserFunctions& calls, const OdeOptions& options, double end_time);
/// For problems with algebraic components.
std::unique_ptr<Stepper> make_ida_stepper(UserFunctions& calls, const OdeOptions& options, double end_time);
std::unique_ptr<Stepper> make_erk_stepper(UserFunctions& calls, const OdeOptions& options, double end_time);
/// For at most most_small components, where SUNDIALS' calls take as long as the right-hand side.
std::unique_ptr<Stepper> make_small_erk_stepper(UserFunctions& calls, const OdeOptions& options,
                                                double end_time);
inline constexpr std::size_t most_small = 27;

/// Completes the status of a solve that ended with the stepper where it is now: flag, step, cause,
/// components, advice.
void describe_failure(const StepFailure& failure, const Stepper& stepper, const UserFunctions& calls,
                      Status& status);

} // namespace rodwake::integrate
