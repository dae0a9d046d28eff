#pragma once
// Step after step of rods and medium, each as long as the tolerance lets it be.
//
// A step is taken twice, whole and in two halves. The difference over 15 is the error of the halves, which is
// taken off (local error of order 6 in the step). Two things are held to the tolerance: the poses, and the
// turning rates that the error of the fields makes in a unit of time, f/(mu v0), as fields last.

#include "coupled_step.hpp"

#include <array>
#include <span>

namespace rodwake::medium {

struct Tolerance {
    double rtol = 1e-8, atol = 1e-10; ///< of coordinate y: rtol min(|y|, 1) + atol
};

/// Poses during a step: before it, in its middle, after it.
struct DoubleStep {
    double time = 0.0, half = 0.0; ///< where it begins, half its length
    std::array<std::vector<double>, 3> poses, rates;
    std::array<std::vector<double>, 3> own; ///< turning rates by own fields, if these are kept

    double end() const { return time + 2.0 * half; }
    /// The polynomial of degree 5 through places and rates.
    std::vector<double> at(double when) const;
    /// Its derivative.
    std::vector<double> rates_at(double when) const;
    /// Adds to `turn` what own fields turned the rods by up to `when`: the integral of the parabola through
    /// `own`, of order 4 of whole steps.
    void add_own_turn(double when, std::vector<double>& turn) const;
};

class StepControl {
public:
    /// `rates`: of the rods in `state`, as ExponentialStep::rates gives them.
    StepControl(CoupledStep& method, Tolerance tolerance, Coupled state, double time, double step);

    /// One step to `limit` at the latest, `longest` at most; false if none short enough keeps the tolerance.
    /// `failures` grows by the steps that did not.
    bool advance(double longest, double limit, long& failures);

    const DoubleStep& last() const { return last_; }
    const Coupled& state() const { return state_; }
    const std::vector<double>& rates() const { return rates_; }
    double time() const { return time_; }
    /// The fields at a time within the last step, by a step of the method from its start or its middle. No
    /// later step depends on it. The span holds until the next call or step.
    std::span<const double> fields_at(double when);
    double next_step() const { return step_; }        ///< that is tried next
    long evaluations() const { return evaluations_; } ///< but for those of the start

private:
    void accept(double step, double limit);

    CoupledStep& method_;
    Tolerance tolerance_;
    Coupled state_;
    Coupled whole_, middle_, end_; ///< of the last attempt; once accepted end_ is the state before the step
    std::vector<double> rates_, middle_rates_, field_error_, rate_error_, own_;
    double time_, step_;
    DoubleStep last_;
    long evaluations_ = 0;
};

} // namespace rodwake::medium
