#pragma once
// One explicit Runge-Kutta step from a Butcher table, of any length. The erk stepper uses it for times inside
// a step: a shorter step from the same point has the method's accuracy, which its Hermite interpolant has
// not.

#include "problem_calls.hpp"
#include "sundials_raii.hpp"

#include <vector>

namespace rodwake::integrate {

class RungeKuttaStep {
public:
    RungeKuttaStep(const ARKodeButcherTableMem& table, std::size_t size);

    /// y1 = the step of length h from (t, y0). Throws StepFailure when a right-hand side fails.
    void operator()(ProblemCalls& calls, double t, State y0, double h, std::span<double> y1);

private:
    std::span<double> slope(int stage) { return {slopes_.data() + stage * size_, size_}; }
    int used_stages() const;
    void add(std::span<double> y, const double* coefficients, int stages, double h);

    const ARKodeButcherTableMem& table_;
    std::size_t size_;
    std::vector<double> slopes_; ///< stage by stage
};

} // namespace rodwake::integrate
