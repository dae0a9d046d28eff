#pragma once

#include "problem_calls.hpp"
#include "step_failure.hpp"
#include "stepper.hpp"

namespace rodwake::integrate {

/// The Status of a solve that ended with the stepper where it is now.
Status describe_failure(const StepFailure& failure, const Stepper& stepper, const ProblemCalls& calls, double wanted);

/// Likely cause and remedy of a SUNDIALS flag, its prefix removed. Unknown flags get a general text.
struct Remedy {
    const char* cause;
    const char* advice;
};
Remedy remedy_for(const std::string& flag);

} // namespace rodwake::integrate
