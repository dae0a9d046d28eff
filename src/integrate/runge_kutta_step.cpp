#include "runge_kutta_step.hpp"

#include "step_failure.hpp"

#include <algorithm>

namespace rodwake::integrate {

RungeKuttaStep::RungeKuttaStep(const ARKodeButcherTableMem& table, std::size_t size)
    : table_(table), size_(size), slopes_(size * static_cast<std::size_t>(table.stages)) {}

/// Without the last ones that serve only the error estimate or the next step.
int RungeKuttaStep::used_stages() const {
    int stages = table_.stages;
    while (table_.b[stages - 1] == 0.0)
        --stages;
    return stages;
}

void RungeKuttaStep::operator()(ProblemCalls& calls, double t, State y0, double h, std::span<double> y1) {
    const int stages = used_stages();
    for (int stage = 0; stage < stages; ++stage) {
        std::copy(y0.begin(), y0.end(), y1.begin());
        add(y1, table_.A[stage], stage, h);
        if (calls.rhs(t + table_.c[stage] * h, y1, slope(stage)) != ProblemCalls::fine)
            throw StepFailure{"RHSFUNC_FAIL", calls.fault()};
    }
    std::copy(y0.begin(), y0.end(), y1.begin());
    add(y1, table_.b, stages, h);
}

void RungeKuttaStep::add(std::span<double> y, const double* coefficients, int stages, double h) {
    for (int stage = 0; stage < stages; ++stage) {
        const double weight = h * coefficients[stage];
        if (weight == 0.0)
            continue;
        const std::span<const double> k = slope(stage);
        for (std::size_t i = 0; i < size_; ++i)
            y[i] += weight * k[i];
    }
}

} // namespace rodwake::integrate
