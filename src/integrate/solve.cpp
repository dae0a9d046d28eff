// The loop over internal steps: events, outputs, segments, and how it ends.

#include "check_problem.hpp"
#include "describe_failure.hpp"
#include "event_finder.hpp"
#include "stepper.hpp"

#include <utility>

namespace rodwake::integrate {

namespace {

class Run {
  public:
    Run(const OdeProblem& problem, const OdeOptions& options, std::span<const double> output_times);
    Solution execute();

  private:
    bool finished() const { return solution_.times.size() == output_times_.size(); }
    double wanted() const { return output_times_.back(); }
    void take_steps();
    bool take_step();
    void require_progress();
    void start_segment();
    /// Stores what the last step holds, up to its first terminal event. False if there was one.
    bool digest_step();
    void store_outputs(double until);
    void store_output(double t);
    void report_step(double until, State state);
    void end(Outcome outcome, double t, State state);
    void fail(StepFailure failure);
    void collect_counts();

    const OdeOptions& options_;
    const std::span<const double> output_times_;
    ProblemCalls calls_;
    std::unique_ptr<Stepper> stepper_;
    Solution solution_;
    long steps_ = 0, stalled_steps_ = 0;
};

std::unique_ptr<Stepper> make_stepper(ProblemCalls& calls, const OdeOptions& options, double end_time) {
    return options.method == Method::erk ? make_erk_stepper(calls, options, end_time)
                                         : make_cvode_stepper(calls, options, end_time);
}
