// Explicit Runge-Kutta steps by ARKODE's ERKStep.

#include "erk_table.hpp"
#include "sundials_stepper.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

namespace rodwake::integrate {

namespace {

using sundials::elements;
using sundials::made;
using sundials::require;

int call_projection(double, N_Vector y, void* calls) {
    static_cast<UserFunctions*>(calls)->project(elements(y));
    return 0;
}

class ErkStepper final : public SundialsStepper {
public:
    ErkStepper(UserFunctions& calls, const OdeOptions& options, double end_time)
        : SundialsStepper(calls, options, end_time),
          table_(erk_table(options.rtol > 1e-6 ? Erk::dormand_prince : Erk::verner)), dense_(table_->q) {}

    void start(double t, State y) override { start(t, y, initial_step(t)); }
    bool advance() override;
    void interpolate(double t, std::span<double> y) override { dense_(*this, calls_, t, y); }
    int order() const override { return table_->q; }
    std::string flag_prefix() const override { return "ARK"; }
    std::vector<double> weighted_errors() const override;

private:
    void start(double t, State y, double first_step);
    int evolve(double from);
    Statistics segment_counts() const override;
    std::string flag_name() const override;

    sundials::ButcherTable table_;
    DenseOutput dense_;
    sundials::ErkMemory memory_;
    int flag_ = ARK_SUCCESS;
};

/// A new integrator, not ERKStepReInit: a restart then equals a fresh solve whatever ARKODE keeps internally.
void ErkStepper::start(double t, State y, double first_step) {
    if (memory_)
        earlier_ = counts();
    set_start(t, y);
    dense_.reset();
    memory_.reset(made(ERKStepCreate(rhs_callback, t, after_.get(), context_.get())));
    void* erk = memory_.get();
    require(ERKStepSetErrHandlerFn(erk, keep_text, static_cast<SundialsStepper*>(this)));
    require(ERKStepSetUserData(erk, &calls_));
    require(ERKStepSetTable(erk, table_.get()));
    require(ERKStepWFtolerances(erk, error_weights_callback));
    require(ERKStepSetMaxHnilWarns(erk, -1));
    require(ERKStepSetInitStep(erk, first_step));
    require(ERKStepSetMaxStep(erk, longest_step()));
    require(ERKStepSetStopTime(erk, end_time_));
    if (calls_.projects())
        require(ERKStepSetPostprocessStepFn(erk, call_projection));
}

/// CVODES shortens the step when a right-hand side asks for it, ERKStep gives up; so do here what CVODES
/// does.
bool ErkStepper::advance() {
    constexpr int max_retries = 20;     // a factor 1e12 in step
    constexpr double shortening = 0.25; // CVODES' own
    const double from = time_;
    before_.swap(after_);
    flag_ = evolve(from);
    for (int retry = 0; flag_ == ARK_UNREC_RHSFUNC_ERR && retry < max_retries; ++retry) {
        const double tried = calls_.last_time() - from;
        if (tried <= 0.0)
            break;
        start(from, state_before(), shortening * tried);
        flag_ = evolve(from);
    }
    if (flag_ < 0)
        before_.swap(after_);
    return flag_ >= 0;
}

int ErkStepper::evolve(double from) {
    double to = from;
    ERKStepSetMaxStep(memory_.get(), longest_step());
    ERKStepSetMinStep(memory_.get(),
                      shortest_step(from)); // refused if above max_step: solve() notices stalled steps
    const int flag = ERKStepEvolve(memory_.get(), end_time_, after_.get(), &to, ARK_ONE_STEP);
    if (flag < 0)
        return flag;
    time_before_ = from;
    time_ = to;
    return flag;
}

std::string ErkStepper::flag_name() const {
    std::unique_ptr<char, sundials::Deleter<std::free>> name(ERKStepGetReturnFlagName(flag_));
    return name.get();
}

std::vector<double> ErkStepper::weighted_errors() const {
    const bool tried = segment_counts().steps > 0 || flag_ == ARK_ERR_FAILURE;
    if (!tried)
        return {};
    return products(memory_.get(), ERKStepGetErrWeights, ERKStepGetEstLocalErrors);
}

Statistics ErkStepper::segment_counts() const {
    Statistics counts;
    ERKStepGetNumSteps(memory_.get(), &counts.steps);
    ERKStepGetNumErrTestFails(memory_.get(), &counts.error_test_failures);
    return counts;
}

} // namespace

std::unique_ptr<Stepper> make_erk_stepper(UserFunctions& calls, const OdeOptions& options, double end_time) {
    return std::make_unique<ErkStepper>(calls, options, end_time);
}

} // namespace rodwake::integrate
