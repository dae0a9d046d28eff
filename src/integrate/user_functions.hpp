#pragma once
// The user's functions as SUNDIALS and the steppers call them: counted, checked for finite results, and with
// exceptions turned into a fault, since none may cross SUNDIALS' C frames.

#include "rodwake/integrate/sensitivity.hpp"

#include <algorithm>
#include <string>

namespace rodwake::integrate {

/// A solve that cannot go on, on its way from where it was noticed to the Status.
struct StepFailure {
    std::string flag;  ///< without the solver's prefix: "RHSFUNC_FAIL"
    std::string cause; ///< empty: the usual cause of this flag
};

class UserFunctions {
public:
    /// What a callback returns to SUNDIALS.
    enum CallbackResult : int { fine = 0, try_shorter_step = 1, give_up = -1 };

    /// `sensitivity`: of which `problem` is the ode, or null.
    UserFunctions(const OdeProblem& problem, const OdeOptions& options,
                  const SensitivityProblem* sensitivity = nullptr);

    /// Once it has thrown it is not called again: CVODES' fixed-point iteration takes `give_up` for a failure
    /// to converge and retries.
    CallbackResult rhs(double t, State y, std::span<double> ydot) noexcept;
    CallbackResult jacobian(double t, State y, double* column_major) noexcept;
    /// S' = (df/dy) S + df/dp, states x parameters. Like rhs, not called again once it has thrown.
    CallbackResult sensitivity_rhs(double t, State y, const Eigen::MatrixXd& S,
                                   Eigen::MatrixXd& S_dot) noexcept;
    bool projects() const { return static_cast<bool>(problem_.project); }
    /// Puts y back on its manifold and keeps how far off it was.
    void project(std::span<double> y) { drift_ = std::max(drift_, problem_.project(y)); }
    double drift() const { return drift_; }
    /// One over the tolerance of each component.
    void error_weights(State y, std::span<double> weights) const noexcept;
    /// Throws StepFailure when the event throws or is not finite.
    double event(std::size_t index, double t, State y);
    /// Of the problem with sensitivities: by the state, and by the parameters if it depends on them. Throws
    /// StepFailure when the function throws or its result has another size.
    Eigen::VectorXd event_gradient(std::size_t index, double t, State y) const;
    /// Throws StepFailure when the function throws.
    std::optional<double> candidate_time(std::size_t index, const Step& step) const;

    std::string component_name(std::size_t index) const;
    const OdeProblem& problem() const { return problem_; }
    const SensitivityProblem* sensitivity() const { return sensitivity_; }
    /// Of the sensitivities: relative, and absolute of parameter j.
    double sensitivity_rtol() const;
    double sensitivity_atol(std::size_t parameter) const;
    long rhs_evaluations() const { return rhs_evaluations_; }
    long event_evaluations() const { return event_evaluations_; }
    /// Time of the most recent right-hand side: the end of the step being tried.
    double last_time() const { return last_time_; }

    /// Why the last call that did not return `fine` did so; empty if there was none since clear_fault.
    const std::string& fault() const { return fault_; }
    bool rhs_threw() const { return rhs_threw_; }
    void clear_fault() {
        if (!fault_.empty())
            fault_.clear();
    }

private:
    CallbackResult linearise(double t, State y);

    const OdeProblem& problem_;
    const SensitivityProblem* sensitivity_;
    double rtol_, atol_;
    /// df/dy and df/dp where they were wanted last: the corrector asks for them several times at one place.
    struct {
        double time = std::numeric_limits<double>::quiet_NaN();
        std::vector<double> state;
        Eigen::MatrixXd by_state, by_parameter;
    } linear_;
    long rhs_evaluations_ = 0, event_evaluations_ = 0;
    double last_time_ = 0.0, drift_ = 0.0;
    bool rhs_threw_ = false;
    std::string fault_;
};

} // namespace rodwake::integrate
