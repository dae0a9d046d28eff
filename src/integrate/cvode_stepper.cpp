// Adams and BDF steps by CVODES.

#include "sundials_stepper.hpp"

#include <algorithm>
#include <cstdlib>
#include <cvodes/cvodes_ls.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

namespace rodwake::integrate {

namespace {

using sundials::elements;
using sundials::made;
using sundials::require;

int call_jacobian(double t, N_Vector y, N_Vector, SUNMatrix matrix, void* calls, N_Vector, N_Vector,
                  N_Vector) {
    return static_cast<UserFunctions*>(calls)->jacobian(t, elements(y), SUNDenseMatrix_Data(matrix));
}

/// The correction that puts y on its manifold; the error estimate is left as it is.
int call_projection(double, N_Vector y, N_Vector correction, double, N_Vector, void* calls) {
    const std::span<double> put = elements(correction);
    std::ranges::copy(elements(y), put.begin());
    static_cast<UserFunctions*>(calls)->project(put);
    N_VLinearSum(1.0, correction, -1.0, y, correction);
    return 0;
}

/// Columns to vectors and back.
void copy(const Eigen::MatrixXd& from, N_Vector* to) {
    for (Eigen::Index j = 0; j < from.cols(); ++j)
        Eigen::Map<Eigen::VectorXd>(elements(to[j]).data(), from.rows()) = from.col(j);
}
void copy(N_Vector* from, Eigen::MatrixXd& to) {
    for (Eigen::Index j = 0; j < to.cols(); ++j)
        to.col(j) = Eigen::Map<Eigen::VectorXd>(elements(from[j]).data(), to.rows());
}

int call_sensitivity_rhs(int parameters, double t, N_Vector y, N_Vector, N_Vector* S, N_Vector* S_dot,
                         void* calls, N_Vector, N_Vector) {
    const State state = elements(y);
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(state.size()), parameters),
        slope(matrix.rows(), parameters);
    copy(S, matrix);
    const int result = static_cast<UserFunctions*>(calls)->sensitivity_rhs(t, state, matrix, slope);
    if (result == UserFunctions::fine)
        copy(slope, S_dot);
    return result;
}

class CvodeStepper final : public SundialsStepper {
public:
    using SundialsStepper::SundialsStepper;

    void start(double t, State y) override;
    bool advance() override;
    void interpolate(double t, std::span<double> y) override;
    Eigen::MatrixXd sensitivities(double t) override;
    int order() const override;
    std::string flag_prefix() const override { return "CV"; }
    std::vector<double> weighted_errors() const override;

private:
    Statistics segment_counts() const override;
    std::string flag_name() const override;

    // The integrator is destroyed before the solvers it points to: members are destroyed in reverse order.
    sundials::Matrix matrix_;
    sundials::LinearSolver linear_solver_;
    sundials::NonlinearSolver fixed_point_, sensitivity_fixed_point_;
    sundials::VectorArray sensitivities_;
    sundials::CvodeMemory memory_;
    int flag_ = CV_SUCCESS;
};

/// A new integrator, not CVodeReInit: a restart then equals a fresh solve whatever CVODES keeps internally.
void CvodeStepper::start(double t, State y) {
    const SensitivityProblem* sensitive = calls_.sensitivity();
    Eigen::MatrixXd start_sensitivities;
    if (sensitive)
        start_sensitivities = memory_ ? sensitivities(t) : sensitive->initial;
    if (memory_)
        earlier_ = counts();
    set_start(t, y);
    const bool bdf = options_.method == Method::bdf;
    memory_.reset(made(CVodeCreate(bdf ? CV_BDF : CV_ADAMS, context_.get())));
    void* cvode = memory_.get();
    require(CVodeSetErrHandlerFn(cvode, keep_text, static_cast<SundialsStepper*>(this)));
    require(CVodeInit(cvode, rhs_callback, t, after_.get()));
    require(CVodeSetUserData(cvode, &calls_));
    require(CVodeWFtolerances(cvode, error_weights_callback));
    require(CVodeSetMaxHnilWarns(cvode, -1));
    require(CVodeSetInitStep(cvode, initial_step(t)));
    require(CVodeSetMaxStep(cvode, longest_step()));
    require(CVodeSetStopTime(cvode, end_time_));

    // The solver of the implicit equation.
    const auto size = static_cast<sunindextype>(state().size());
    if (bdf) {
        if (!matrix_)
            matrix_.reset(made(SUNDenseMatrix(size, size, context_.get())));
        linear_solver_.reset(made(SUNLinSol_Dense(after_.get(), matrix_.get(), context_.get())));
        require(CVodeSetLinearSolver(cvode, linear_solver_.get(), matrix_.get()));
        if (calls_.problem().jacobian)
            require(CVodeSetJacFn(cvode, call_jacobian));
    } else { // the previous integrator is gone already, so its solver can go too
        fixed_point_.reset(made(SUNNonlinSol_FixedPoint(after_.get(), 0, context_.get())));
        require(CVodeSetNonlinearSolver(cvode, fixed_point_.get()));
    }
    if (calls_.projects()) {
        require(CVodeSetProjFn(cvode, call_projection));
        require(CVodeSetProjErrEst(cvode, SUNFALSE));
        require(CVodeSetProjFrequency(cvode, 1));
    }
    if (!sensitive)
        return;

    // Staggered: the state's corrector and error test come first, and the sensitivities' corrector needs the
    // Jacobian once a step. With Newton CVODES makes the solver of both itself.
    const auto count = static_cast<int>(start_sensitivities.cols());
    if (!sensitivities_)
        sensitivities_ = sundials::VectorArray(made(N_VCloneVectorArray(count, after_.get())), {count});
    copy(start_sensitivities, sensitivities_.get());
    std::vector<double> atol(start_sensitivities.cols());
    for (std::size_t j = 0; j < atol.size(); ++j)
        atol[j] = calls_.sensitivity_atol(j);
    require(CVodeSensInit(cvode, count, CV_STAGGERED, call_sensitivity_rhs, sensitivities_.get()));
    require(CVodeSensSStolerances(cvode, calls_.sensitivity_rtol(), atol.data()));
    require(CVodeSetSensErrCon(cvode, SUNTRUE));
    if (bdf)
        return;
    sensitivity_fixed_point_.reset(made(SUNNonlinSol_FixedPointSens(count, after_.get(), 0, context_.get())));
    require(CVodeSetNonlinearSolverSensStg(cvode, sensitivity_fixed_point_.get()));
}

bool CvodeStepper::advance() {
    before_.swap(after_);
    const double from = time_;
    double to = from;
    CVodeSetMaxStep(memory_.get(), longest_step());
    CVodeSetMinStep(memory_.get(),
                    shortest_step(from)); // refused if above max_step: solve() notices stalled steps
    flag_ = CVode(memory_.get(), end_time_, after_.get(), &to, CV_ONE_STEP);
    if (flag_ < 0) {
        before_.swap(after_);
        return false;
    }
    time_before_ = from;
    time_ = to;
    return true;
}

void CvodeStepper::interpolate(double t, std::span<double> y) {
    N_VSetArrayPointer(y.data(), view_.get());
    if (CVodeGetDky(memory_.get(), t, 0, view_.get()) != CV_SUCCESS)
        throw StepFailure{"BAD_T", solver_text_};
}

Eigen::MatrixXd CvodeStepper::sensitivities(double t) {
    Eigen::MatrixXd S = calls_.sensitivity()->initial;
    // where the segment started they are there, untouched until asked for the first time
    if (segment_counts().steps > 0 &&
        CVodeGetSensDky(memory_.get(), t, 0, sensitivities_.get()) != CV_SUCCESS)
        throw StepFailure{"BAD_T", solver_text_};
    copy(sensitivities_.get(), S);
    return S;
}

int CvodeStepper::order() const {
    int order = 0;
    CVodeGetCurrentOrder(memory_.get(), &order);
    return order;
}

std::string CvodeStepper::flag_name() const {
    std::unique_ptr<char, sundials::Deleter<std::free>> name(CVodeGetReturnFlagName(flag_));
    return name.get();
}

std::vector<double> CvodeStepper::weighted_errors() const {
    // Before the first corrector iteration CVODES has no estimate, only memory that nobody has written.
    const bool tried = segment_counts().steps > 0 || flag_ == CV_ERR_FAILURE;
    if (!tried)
        return {};
    return products(memory_.get(), CVodeGetErrWeights, CVodeGetEstLocalErrors);
}

Statistics CvodeStepper::segment_counts() const {
    Statistics counts;
    void* cvode = memory_.get();
    CVodeGetNumSteps(cvode, &counts.steps);
    CVodeGetNumErrTestFails(cvode, &counts.error_test_failures);
    CVodeGetNumNonlinSolvConvFails(cvode, &counts.convergence_failures);
    if (matrix_)
        CVodeGetNumJacEvals(cvode, &counts.jacobian_evaluations);
    return counts;
}

} // namespace

std::unique_ptr<Stepper> make_cvode_stepper(UserFunctions& calls, const OdeOptions& options,
                                            double end_time) {
    return std::make_unique<CvodeStepper>(calls, options, end_time);
}

} // namespace rodwake::integrate
