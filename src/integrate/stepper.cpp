#include "stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace rodwake::integrate {

Stepper::Stepper(ProblemCalls& calls, const OdeOptions& options, double end_time)
    : calls_(calls), options_(options), end_time_(end_time) {
    const std::size_t size = calls.problem().initial_state.size();
    before_ = sundials::make_vector(size, context_.get());
    after_ = sundials::make_vector(size, context_.get());
    view_ = sundials::Vector(
        sundials::made(N_VMake_Serial(static_cast<sunindextype>(size), nullptr, context_.get())));
}

void Stepper::set_start(double t, State y) {
    // y may be state() itself.
    std::copy(y.begin(), y.end(), sundials::elements(before_.get()).begin());
    std::copy(state_before().begin(), state_before().end(), sundials::elements(after_.get()).begin());
    time_ = time_before_ = t;
}

Eigen::MatrixXd Stepper::sensitivities(double) {
    throw std::logic_error("this integrator has no sensitivities");
}

Statistics Stepper::counts() const {
    Statistics sum = earlier_;
    return sum += segment_counts();
}

int Stepper::rhs_callback(double t, N_Vector y, N_Vector ydot, void* calls) {
    return static_cast<ProblemCalls*>(calls)->rhs(t, sundials::elements(y), sundials::elements(ydot));
}

int Stepper::error_weights_callback(N_Vector y, N_Vector weights, void* calls) {
    static_cast<ProblemCalls*>(calls)->error_weights(sundials::elements(y), sundials::elements(weights));
    return 0;
}

std::vector<double> Stepper::products(void* memory, Getter a, Getter b) const {
    const sundials::Vector first = sundials::make_vector(state().size(), context_.get());
    const sundials::Vector second = sundials::make_vector(state().size(), context_.get());
    a(memory, first.get());
    b(memory, second.get());
    N_VProd(first.get(), second.get(), second.get());
    N_VAbs(second.get(), second.get());
    N_VScale(1.0 / std::sqrt(static_cast<double>(state().size())), second.get(), second.get());
    return {sundials::elements(second.get()).begin(), sundials::elements(second.get()).end()};
}

StepFailure Stepper::failure() const {
    if (calls_.rhs_threw())
        return {"RHSFUNC_FAIL", calls_.fault()};
    return {flag_name().substr(flag_prefix().size() + 1), calls_.fault()};
}

double Stepper::initial_step(double t) const {
    const double left = end_time_ - t;
    // SUNDIALS refuses to choose a step when the end is within round-off of the start.
    const double round_off =
        8.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), std::abs(end_time_));
    if (left < round_off)
        return left;
    return std::min(options_.initial_step, left);
}

double Stepper::longest_step() const {
    const auto& limit = calls_.problem().step_limit;
    if (!limit)
        return options_.max_step;
    const double here = limit(time_, state_before());
    return options_.max_step > 0.0 ? std::min(here, options_.max_step) : here;
}

double Stepper::shortest_step(double t) { return 2.0 * std::numeric_limits<double>::epsilon() * std::abs(t); }

void Stepper::keep_text(int flag, const char*, const char*, char* text, void* stepper) {
    if (flag < 0)
        static_cast<Stepper*>(stepper)->solver_text_ = text;
}

} // namespace rodwake::integrate
