#include "quintic.hpp"

namespace rodwake::integrate {

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
