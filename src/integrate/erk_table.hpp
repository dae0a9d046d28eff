#pragma once
// The explicit Runge-Kutta methods of more than 27 components, as ARKODE has them.

#include "stepper.hpp"
#include "sundials_raii.hpp"

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace rodwake::integrate {

/// Dormand-Prince 5(4) for loose tolerances, Verner 6(5) for tight ones, where the higher order pays for its
/// extra stages. Both propagate the higher of their two orders.
enum class Erk { dormand_prince, verner };

/// Its last stage is the first of the next step.
sundials::ButcherTable erk_table(Erk method);

/// The solution inside a Runge-Kutta step, to the order q of the method: a polynomial of degree q through the
/// states at the ends and the rates at q - 1 places. Rates in the middle come of the polynomial of one degree
/// less, whose error is multiplied by the step, and so on down to the cubic through states and rates at the
/// ends (Enright, Jackson, Norsett & Thomsen, ACM Trans. Math. Softw. 12, 193, 1986). Made once a step, by 3
/// right-hand sides for order 5 and 6 for order 6, and 2 more where those at the ends are not known.
class DenseOutput {
public:
    explicit DenseOutput(int order) : order_(order) {}

    /// Forgets the step.
    void reset() { from_ = to_ = std::numeric_limits<double>::quiet_NaN(); }

    /// The state at a time in the stepper's last step. `slope_before`, `slope_after`: rates at its ends, or
    /// empty. Throws StepFailure.
    void operator()(const Stepper& stepper, UserFunctions& calls, double t, std::span<double> y,
                    State slope_before = {}, State slope_after = {});

private:
    void make(const Stepper& stepper, UserFunctions& calls, State slope_before, State slope_after);
    void evaluate(double u, std::span<double> y) const;

    int order_;
    double from_ = std::numeric_limits<double>::quiet_NaN(), to_ = from_; ///< the step it is of
    Eigen::VectorXd start_;
    Eigen::MatrixXd powers_; ///< (y - start)/h: column k times u^(k + 1)
};

} // namespace rodwake::integrate
