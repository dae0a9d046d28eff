#pragma once
// The loop over internal steps: events, outputs, segments, and how it ends. With sensitivities if there are
// any.

#include "event_sampler.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/integrate/sensitivity.hpp"
#include "stepper.hpp"

#include <memory>
#include <optional>

namespace rodwake::integrate {

class Run {
public:
    /// `sensitivity`: of which `problem` is the ode, or null.
    Run(const OdeProblem& problem, const SensitivityProblem* sensitivity, const OdeOptions& options,
        std::span<const double> output_times);

    SensitivitySolution execute();

private:
    // These say whether the solve goes on; if not, the termination is set.
    bool advance();
    bool digest_step();
    bool end(Termination termination, double t, State state);
    bool fail(const StepFailure& failure, double reached, State state);

    void store_outputs(double until);
    Statistics statistics() const;
    bool all_stored() const { return solution_.times.size() == output_times_.size(); }
    /// How the time of the terminal event that ended the solve depends on the parameters.
    Eigen::VectorXd event_time_by_parameter(const EventHit& hit);

    const OdeOptions& options_;
    const std::span<const double> output_times_;
    UserFunctions calls_;
    std::unique_ptr<Stepper> stepper_;
    std::optional<EventFinder> events_;
    SensitivitySolution result_;
    Solution& solution_ = result_.solution;
    long steps_ = 0, stalled_steps_ = 0;
};

/// Throws InputError for what solve() cannot start from; the message names the offending value and what is
/// legal.
void check_problem(const OdeProblem& problem, const OdeOptions& options,
                   std::span<const double> output_times);

} // namespace rodwake::integrate
