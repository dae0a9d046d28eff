#include "erk_table.hpp"

#include <algorithm>
#include <utility>

namespace rodwake::integrate {

namespace {

/// The same method with y1 itself as its last stage. ERKStep 6.4.1 takes the last slope of any table that
/// ends in c = 1 for the first slope of the next step (llnl/sundials issue 311), which costs Verner's table,
/// as shipped, its order. With this stage the assumption is true, at the same number of right-hand sides.
sundials::ButcherTable with_first_same_as_last(sundials::ButcherTable method) {
    const int stages = method->stages;
    sundials::ButcherTable extended(sundials::made(ARKodeButcherTable_Alloc(stages + 1, 1)));
    extended->q = method->q;
    extended->p = method->p;
    for (int i = 0; i < stages; ++i)
        std::copy_n(method->A[i], stages, extended->A[i]);
    std::copy_n(method->b, stages, extended->A[stages]);
    std::copy_n(method->b, stages, extended->b);
    std::copy_n(method->d, stages, extended->d);
    std::copy_n(method->c, stages, extended->c);
    extended->c[stages] = 1.0;
    return extended;
}

} // namespace

sundials::ButcherTable erk_table(Erk method) {
    const bool verner = method == Erk::verner;
    sundials::ButcherTable table(sundials::made(
        ARKodeButcherTable_LoadERK(verner ? ARKODE_VERNER_8_5_6 : ARKODE_DORMAND_PRINCE_7_4_5)));
    return verner ? with_first_same_as_last(std::move(table)) : std::move(table);
}

namespace {

constexpr std::array<double, 6> nodes = {0.0, 0.0, 0.5, 0.5, 1.0, 1.0}; // of the step: state and rate

} // namespace

void Quintic::operator()(Stepper& stepper, ProblemCalls& calls, double t, std::span<double> y) {
    if (stepper.time_before() != from_ || stepper.time() != to_)
        make(stepper, calls);
    const double u = (t - from_) / (to_ - from_);
    for (std::size_t i = 0; i < y.size(); ++i) {
        y[i] = c_[5][i];
        for (std::size_t k = 5; k-- > 0;)
            y[i] = c_[k][i] + (u - nodes[k]) * y[i];
    }
}

void Quintic::make(Stepper& stepper, ProblemCalls& calls) {
    from_ = stepper.time_before();
    to_ = stepper.time();
    const double middle = from_ + 0.5 * (to_ - from_);
    for (std::vector<double>& c : c_)
        c.resize(stepper.state().size());
    std::vector<double> inner(stepper.state().size());
    stepper.interpolate(middle, inner);
    const std::array<State, 3> states = {stepper.state_before(), inner, stepper.state()};
    const std::array<double, 3> times = {from_, middle, to_};
    for (std::size_t j = 0; j < 3; ++j)
        if (calls.rhs(times[j], states[j], c_[2 * j + 1]) != ProblemCalls::fine) {
            from_ = std::numeric_limits<double>::quiet_NaN();
            throw StepFailure{"RHSFUNC_FAIL", calls.fault()};
        }
    for (std::size_t i = 0; i < inner.size(); ++i) {
        std::array<double, 6> f{};
        for (std::size_t j = 0; j < 6; ++j)
            f[j] = states[j / 2][i];
        for (std::size_t order = 1; order < 6; ++order)
            for (std::size_t j = 5; j >= order; --j) {
                const double gap = nodes[j] - nodes[j - order];
                f[j] = gap > 0.0 ? (f[j] - f[j - 1]) / gap : (to_ - from_) * c_[j][i];
            }
        for (std::size_t k = 0; k < 6; ++k)
            c_[k][i] = f[k];
    }
}

} // namespace rodwake::integrate
