#include "erk_table.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace rodwake::integrate {

sundials::ButcherTable erk_table(Erk method) {
    const bool verner = method == Erk::verner;
    sundials::ButcherTable table(sundials::made(
        ARKodeButcherTable_LoadERK(verner ? ARKODE_VERNER_8_5_6 : ARKODE_DORMAND_PRINCE_7_4_5)));
    if (!verner)
        return table;

    // The same method with y1 itself as its last stage. ERKStep 6.4.1 takes the last slope of any table that
    // ends in c = 1 for the first slope of the next step (llnl/sundials issue 311), which costs Verner's
    // table, as shipped, its order. With this stage the assumption is true, at the same number of right-hand
    // sides.
    const int stages = table->stages;
    sundials::ButcherTable extended(sundials::made(ARKodeButcherTable_Alloc(stages + 1, 1)));
    extended->q = table->q;
    extended->p = table->p;
    for (int i = 0; i < stages; ++i)
        std::copy_n(table->A[i], stages, extended->A[i]);
    std::copy_n(table->b, stages, extended->A[stages]);
    std::copy_n(table->b, stages, extended->b);
    std::copy_n(table->d, stages, extended->d);
    std::copy_n(table->c, stages, extended->c);
    extended->c[stages] = 1.0;
    return extended;
}

namespace {

/// Where rates are taken, by the number of those in the middle: with these both the polynomial's own error
/// and its response to errors of the rates are nearly least. A quadrature rule of high order would determine
/// nothing.
const std::vector<double> places[] = {
    {0.0, 1.0}, {0.0, 0.25, 1.0}, {0.0, 0.2, 0.8, 1.0}, {0.0, 0.15, 0.4, 0.85, 1.0}};

/// From the mean slope of the step and the rates at the places to the powers of u.
Eigen::MatrixXd powers_from(const std::vector<double>& at) {
    const auto n = static_cast<Eigen::Index>(at.size()) + 1;
    Eigen::MatrixXd conditions(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        conditions(0, k) = 1.0;
        for (Eigen::Index i = 1; i < n; ++i)
            conditions(i, k) = static_cast<double>(k + 1) * std::pow(at[static_cast<std::size_t>(i - 1)], k);
    }
    return conditions.inverse().transpose();
}

} // namespace

void DenseOutput::operator()(const Stepper& stepper, UserFunctions& calls, double t, std::span<double> y,
                             State slope_before, State slope_after) {
    if (stepper.time_before() != from_ || stepper.time() != to_)
        make(stepper, calls, slope_before, slope_after);
    if (t == to_) // to the bit
        std::ranges::copy(stepper.state(), y.begin());
    else
        evaluate((t - from_) / (to_ - from_), y);
}

void DenseOutput::evaluate(double u, std::span<double> y) const {
    for (Eigen::Index i = 0; i < start_.size(); ++i) {
        double sum = 0.0;
        for (Eigen::Index k = powers_.cols(); k-- > 0;)
            sum = (sum + powers_(i, k)) * u;
        y[static_cast<std::size_t>(i)] = start_[i] + (to_ - from_) * sum;
    }
}

void DenseOutput::make(const Stepper& stepper, UserFunctions& calls, State slope_before, State slope_after) {
    const double from = stepper.time_before(), to = stepper.time();
    const auto n = static_cast<Eigen::Index>(stepper.state().size());
    const auto vector = [n](State state) { return Eigen::Map<const Eigen::VectorXd>(state.data(), n); };
    const auto rate = [&](double t, State y, State known, Eigen::Ref<Eigen::VectorXd> slope) {
        if (!known.empty())
            slope = vector(known);
        else if (calls.rhs(t, y, {slope.data(), y.size()}) != UserFunctions::fine)
            throw StepFailure{"RHSFUNC_FAIL", calls.fault()};
    };
    static const std::array<Eigen::MatrixXd, 4> powers_of_rates = {
        powers_from(places[0]), powers_from(places[1]), powers_from(places[2]), powers_from(places[3])};
    reset(); // what a failure leaves
    start_ = vector(stepper.state_before());
    Eigen::MatrixXd known(n, order_); // mean slope, then rates
    known.col(0) = (vector(stepper.state()) - start_) / (to - from);
    Eigen::VectorXd first(n), last(n), inner(n);
    rate(from, stepper.state_before(), slope_before, first);
    rate(to, stepper.state(), slope_after, last);
    for (std::size_t middle = 0; middle + 3 <= static_cast<std::size_t>(order_); ++middle) {
        const std::vector<double>& at = places[middle];
        known.col(1) = first;
        for (std::size_t k = 1; k <= middle; ++k) { // by the polynomial before
            const double t = from + at[k] * (to - from);
            from_ = from, to_ = to;
            evaluate(at[k], {inner.data(), static_cast<std::size_t>(n)});
            reset();
            rate(t, {inner.data(), static_cast<std::size_t>(n)}, {},
                 known.col(static_cast<Eigen::Index>(k) + 1));
        }
        known.col(static_cast<Eigen::Index>(middle) + 2) = last;
        powers_ = known.leftCols(static_cast<Eigen::Index>(middle) + 3) * powers_of_rates[middle];
    }
    from_ = from;
    to_ = to;
}

} // namespace rodwake::integrate
