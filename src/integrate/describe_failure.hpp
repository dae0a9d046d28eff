#pragma once

#include "problem_calls.hpp"
#include "step_failure.hpp"
#include "stepper.hpp"

namespace rodwake::integrate {

/// Completes the status of a solve that ended with the stepper where it is now: flag, step, cause,
/// components, advice.
void describe_failure(const StepFailure& failure, const Stepper& stepper, const ProblemCalls& calls,
                      Status& status);

/// Likely cause and remedy of a SUNDIALS flag, its prefix removed. Flags without an entry have no cause here.
struct Remedy {
    const char* cause; ///< or null
    const char* advice;
};
Remedy remedy_for(const std::string& flag);

} // namespace rodwake::integrate
