// Steps of problems with algebraic components by IDAS:  F(t, y, y') = M y' - f(t, y) = 0.

#include "sundials_stepper.hpp"

#include <cstdlib>
#include <idas/idas_ls.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

namespace rodwake::integrate {

namespace {

using sundials::elements;
using sundials::made;
using sundials::require;

int call_residual(double t, N_Vector y, N_Vector slope, N_Vector residual, void* user) {
    auto& calls = *static_cast<UserFunctions*>(user);
    const std::span<double> f = elements(residual), dy = elements(slope);
    const UserFunctions::CallbackResult result = calls.rhs(t, elements(y), f);
    const std::vector<bool>& algebraic = calls.problem().algebraic;
    for (std::size_t i = 0; i < f.size(); ++i)
        f[i] = (algebraic[i] ? 0.0 : dy[i]) - f[i];
    return result;
}

/// dF/dy + c dF/dy' = c M - J
int call_jacobian(double t, double c, N_Vector y, N_Vector, N_Vector, SUNMatrix matrix, void* user, N_Vector,
                  N_Vector, N_Vector) {
    auto& calls = *static_cast<UserFunctions*>(user);
    const auto size = static_cast<Eigen::Index>(elements(y).size());
    const UserFunctions::CallbackResult result = calls.jacobian(t, elements(y), SUNDenseMatrix_Data(matrix));
    Eigen::Map<Eigen::MatrixXd> system(SUNDenseMatrix_Data(matrix), size, size);
    system *= -1.0;
    for (Eigen::Index i = 0; i < size; ++i)
        if (!calls.problem().algebraic[static_cast<std::size_t>(i)])
            system(i, i) += c;
    return result;
}

class IdaStepper final : public SundialsStepper {
public:
    IdaStepper(UserFunctions& calls, const OdeOptions& options, double end_time);

    void start(double t, State y) override;
    bool advance() override;
    void interpolate(double t, std::span<double> y) override;
    int order() const override;
    std::string flag_prefix() const override { return "IDA"; }
    std::vector<double> weighted_errors() const override;

private:
    Statistics segment_counts() const override;
    std::string flag_name() const override;

    sundials::Vector slope_, differential_; ///< y'; 1 for differential components, 0 for algebraic ones
    sundials::Matrix matrix_;
    sundials::LinearSolver linear_solver_;
    sundials::IdaMemory memory_;
    std::vector<double> projected_; ///< scratch
    bool consistent_ = false;       ///< y and y' at the start solve the equations
    int flag_ = IDA_SUCCESS;
};

IdaStepper::IdaStepper(UserFunctions& calls, const OdeOptions& options, double end_time)
    : SundialsStepper(calls, options, end_time) {
    const std::vector<bool>& algebraic = calls.problem().algebraic;
    slope_ = sundials::make_vector(algebraic.size(), context_.get());
    differential_ = sundials::make_vector(algebraic.size(), context_.get());
    for (std::size_t i = 0; i < algebraic.size(); ++i)
        elements(differential_.get())[i] = algebraic[i] ? 0.0 : 1.0;
}

/// A new integrator, as in CvodeStepper::start.
void IdaStepper::start(double t, State y) {
    if (memory_)
        earlier_ = counts();
    set_start(t, y);

    // y' before the algebraic components are known. IDACalcIC takes its scale of time from it: from zero it
    // would take that of the whole run, which fails where the run is long or the problem stiff.
    const std::span<double> slope = elements(slope_.get());
    if (calls_.rhs(time_, state(), slope) != UserFunctions::fine)
        N_VConst(0.0, slope_.get()); // the solver reports it
    const std::vector<bool>& algebraic = calls_.problem().algebraic;
    for (std::size_t i = 0; i < slope.size(); ++i)
        if (algebraic[i])
            slope[i] = 0.0;

    memory_.reset(made(IDACreate(context_.get())));
    void* ida = memory_.get();
    require(IDASetErrHandlerFn(ida, keep_text, static_cast<SundialsStepper*>(this)));
    require(IDAInit(ida, call_residual, t, after_.get(), slope_.get()));
    require(IDASetUserData(ida, &calls_));
    require(IDAWFtolerances(ida, error_weights_callback));
    require(IDASetId(ida, differential_.get()));
    require(IDASetSuppressAlg(ida, SUNTRUE));
    require(IDASetInitStep(ida, initial_step(t)));
    require(IDASetStopTime(ida, end_time_));
    const auto size = static_cast<sunindextype>(state().size());
    if (!matrix_)
        matrix_.reset(made(SUNDenseMatrix(size, size, context_.get())));
    linear_solver_.reset(made(SUNLinSol_Dense(after_.get(), matrix_.get(), context_.get())));
    require(IDASetLinearSolver(ida, linear_solver_.get(), matrix_.get()));
    if (calls_.problem().jacobian)
        require(IDASetJacFn(ida, call_jacobian));
    consistent_ = false;
}

bool IdaStepper::advance() {
    if (!consistent_) { // find the algebraic components and y' from the differential components
        flag_ = IDACalcIC(memory_.get(), IDA_YA_YDP_INIT, end_time_);
        if (flag_ < 0)
            return false;
        require(IDAGetConsistentIC(memory_.get(), after_.get(), slope_.get()));
        consistent_ = true;
    }
    before_.swap(after_);
    const double from = time_;
    double to = from;
    IDASetMaxStep(memory_.get(), longest_step());
    flag_ = IDASolve(memory_.get(), end_time_, &to, after_.get(), slope_.get(), IDA_ONE_STEP);
    if (flag_ < 0) {
        before_.swap(after_);
        return false;
    }
    time_before_ = from;
    time_ = to;
    if (calls_.projects()) { // a copy, which records the drift
        projected_.assign(state().begin(), state().end());
        calls_.project(projected_);
    }
    return true;
}

void IdaStepper::interpolate(double t, std::span<double> y) {
    N_VSetArrayPointer(y.data(), view_.get());
    if (IDAGetDky(memory_.get(), t, 0, view_.get()) != IDA_SUCCESS)
        throw StepFailure{"BAD_T", solver_text_};
}

int IdaStepper::order() const {
    int order = 0;
    IDAGetLastOrder(memory_.get(), &order);
    return order;
}

std::string IdaStepper::flag_name() const {
    std::unique_ptr<char, sundials::Deleter<std::free>> name(IDAGetReturnFlagName(flag_));
    return name.get();
}

std::vector<double> IdaStepper::weighted_errors() const {
    const bool tried = segment_counts().steps > 0 || flag_ == IDA_ERR_FAIL;
    return tried ? products(memory_.get(), IDAGetErrWeights, IDAGetEstLocalErrors) : std::vector<double>{};
}

Statistics IdaStepper::segment_counts() const {
    Statistics counts;
    void* ida = memory_.get();
    IDAGetNumSteps(ida, &counts.steps);
    IDAGetNumErrTestFails(ida, &counts.error_test_failures);
    IDAGetNumNonlinSolvConvFails(ida, &counts.convergence_failures);
    IDAGetNumJacEvals(ida, &counts.jacobian_evaluations);
    return counts;
}

} // namespace

std::unique_ptr<Stepper> make_ida_stepper(UserFunctions& calls, const OdeOptions& options, double end_time) {
    return std::make_unique<IdaStepper>(calls, options, end_time);
}

} // namespace rodwake::integrate
