#include "sundials_stepper.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::integrate {

SundialsStepper::SundialsStepper(UserFunctions& calls, const OdeOptions& options, double end_time)
    : Stepper(calls, options, end_time) {
    const std::size_t size = calls.problem().initial_state.size();
    before_ = sundials::make_vector(size, context_.get());
    after_ = sundials::make_vector(size, context_.get());
    view_ = sundials::Vector(
        sundials::made(N_VMake_Serial(static_cast<sunindextype>(size), nullptr, context_.get())));
}

void SundialsStepper::set_start(double t, State y) {
    // y may be state() itself.
    std::copy(y.begin(), y.end(), sundials::elements(before_.get()).begin());
    std::copy(state_before().begin(), state_before().end(), sundials::elements(after_.get()).begin());
    time_ = time_before_ = t;
}

int SundialsStepper::rhs_callback(double t, N_Vector y, N_Vector ydot, void* calls) {
    return static_cast<UserFunctions*>(calls)->rhs(t, sundials::elements(y), sundials::elements(ydot));
}

int SundialsStepper::error_weights_callback(N_Vector y, N_Vector weights, void* calls) {
    static_cast<UserFunctions*>(calls)->error_weights(sundials::elements(y), sundials::elements(weights));
    return 0;
}

std::vector<double> SundialsStepper::products(void* memory, Getter a, Getter b) const {
    const sundials::Vector first = sundials::make_vector(state().size(), context_.get());
    const sundials::Vector second = sundials::make_vector(state().size(), context_.get());
    a(memory, first.get());
    b(memory, second.get());
    N_VProd(first.get(), second.get(), second.get());
    N_VAbs(second.get(), second.get());
    N_VScale(1.0 / std::sqrt(static_cast<double>(state().size())), second.get(), second.get());
    return {sundials::elements(second.get()).begin(), sundials::elements(second.get()).end()};
}

void SundialsStepper::keep_text(int flag, const char*, const char*, char* text, void* stepper) {
    if (flag < 0)
        static_cast<SundialsStepper*>(stepper)->solver_text_ = text;
}

} // namespace rodwake::integrate
