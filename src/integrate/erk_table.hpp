#pragma once
// The explicit Runge-Kutta methods in use, as ARKODE has them.

#include "stepper.hpp"
#include "sundials_raii.hpp"

#include <array>
#include <limits>
#include <vector>

namespace rodwake::integrate {

/// Dormand-Prince 5(4) for loose tolerances, Verner 6(5) for tight ones, where the higher order pays for its
/// extra stages. Both propagate the higher of their two orders.
enum class Erk { dormand_prince, verner };

/// Its last stage is the first of the next step.
sundials::ButcherTable erk_table(Erk method);

// The quintic through the states and rates at the ends and in the middle of a Runge-Kutta step.

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
