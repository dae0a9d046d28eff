#pragma once
// The quintic through the states and rates at the ends and in the middle of a Runge-Kutta step.

#include "stepper.hpp"

#include <array>
#include <limits>
#include <vector>

namespace rodwake::integrate {

class Quintic {
public:
    /// The state at a time in the stepper's last step. Made once a step, by its interpolate() and three
    /// right-hand sides. Throws StepFailure.
    void operator()(Stepper& stepper, ProblemCalls& calls, double t, std::span<double> y);

private:
    void make(Stepper& stepper, ProblemCalls& calls);

    double from_ = std::numeric_limits<double>::quiet_NaN(), to_ = from_; ///< the step it is of
    std::array<std::vector<double>, 6> c_;                                ///< divided differences
};

} // namespace rodwake::integrate
