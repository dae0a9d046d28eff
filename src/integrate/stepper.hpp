#pragma once
// One internal step at a time, whatever integrator takes it: what solve() needs to know of SUNDIALS.

#include "problem_calls.hpp"
#include "rodwake/integrate/ode.hpp"
#include "sundials_raii.hpp"

#include <memory>

namespace rodwake::integrate {

class Stepper {
public:
    Stepper(ProblemCalls& calls, const OdeOptions& options, double end_time);
    Stepper(const Stepper&) = delete;
    Stepper& operator=(const Stepper&) = delete;
    virtual ~Stepper() = default;

    /// Discards all history: what follows depends on (t, y), the options and the end time alone.
    virtual void start(double t, State y) = 0;
    /// Takes one step, not beyond the end time. False if it failed: see flag_name().
    virtual bool advance() = 0;
    /// The solution at a time within the last step, with the accuracy of the method.
    virtual void interpolate(double t, std::span<double> y) = 0;
    /// dy/dp at a time within the last step, if the problem has parameters and the integrator can.
    virtual Eigen::MatrixXd sensitivities(double t);

    virtual int order() const = 0;
    /// The solver's own text about its last failure.
    const std::string& solver_text() const { return solver_text_; }
    /// After advance() failed.
    StepFailure failure() const;
    /// "CV" or "ARK".
    virtual std::string flag_prefix() const = 0;
    /// Estimated local error times error weight (1 / tolerance) of each component in the step tried last;
    /// empty when no step has been tried.
    virtual std::vector<double> weighted_errors() const = 0;
    /// The integrator's own counts since construction: steps, failures, Jacobians.
    Statistics counts() const;

    Step step() const { return {time_before_, time_, state_before(), state()}; }
    double time_before() const { return time_before_; }
    double time() const { return time_; }
    State state_before() const { return sundials::elements(before_.get()); }
    State state() const { return sundials::elements(after_.get()); }

protected:
    /// Counts since start().
    virtual Statistics segment_counts() const = 0;
    /// "CV_ERR_FAILURE", of the last step.
    virtual std::string flag_name() const = 0;
    void set_start(double t, State y);
    /// The initial step to ask for at t; 0: the solver's choice.
    double initial_step(double t) const;
    /// The longest step to take from state_before(), where a step begins; 0: no limit.
    double longest_step() const;
    /// The shortest step worth trying at t: shorter ones may not change t.
    static double shortest_step(double t);
    // The problem's functions as SUNDIALS calls them; the user data are the ProblemCalls.
    static int rhs_callback(double t, N_Vector y, N_Vector ydot, void* calls);
    static int error_weights_callback(N_Vector y, N_Vector weights, void* calls);
    /// Error over tolerance of each component, from the weights and errors that an integrator hands out.
    using Getter = int (*)(void* memory, N_Vector);
    std::vector<double> products(void* memory, Getter a, Getter b) const;
    static void keep_text(int flag, const char* module, const char* function, char* text, void* stepper);

    ProblemCalls& calls_;
    const OdeOptions& options_;
    const double end_time_;
    sundials::Context context_ = sundials::make_context();
    sundials::Vector before_, after_;
    sundials::Vector view_; ///< wraps a caller's array
    double time_before_ = 0.0, time_ = 0.0;
    Statistics earlier_; ///< counts of the integrators of earlier segments
    std::string solver_text_;
};

std::unique_ptr<Stepper> make_cvode_stepper(ProblemCalls& calls, const OdeOptions& options, double end_time);
std::unique_ptr<Stepper> make_erk_stepper(ProblemCalls& calls, const OdeOptions& options, double end_time);

/// Completes the status of a solve that ended with the stepper where it is now: flag, step, cause,
/// components, advice.
void describe_failure(const StepFailure& failure, const Stepper& stepper, const ProblemCalls& calls,
                      Status& status);

} // namespace rodwake::integrate
