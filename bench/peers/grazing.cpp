// Whether straight walkers meet, as other solvers' events tell it: for studies/validate_certificates.py.
//
//   bench_grazing POINTS.csv
//
// A line of the CSV: R_1 - R_0 (x, y), both headings, contact distance, t_end. Of each it prints a line of 0
// and 1: contact by CVODES (Adams) with its own root finder at rtol 1e-6 and 1e-10, and by odeint's dopri5
// with dense output, the sign of separation less contact distance looked at after each step, at the same two.

#include <boost/numeric/odeint.hpp>
#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace {

using State = std::array<double, 2>;

struct Encounter {
    double x, y, first, second, contact, t_end;

    State velocity() const {
        return {std::cos(second) - std::cos(first), std::sin(second) - std::sin(first)};
    }
    double gap(double dx, double dy) const { return std::hypot(dx, dy) - contact; }
};

bool dopri5_meets(const Encounter& one, double rtol) {
    namespace odeint = boost::numeric::odeint;
    auto stepper = odeint::make_dense_output(rtol, rtol, odeint::runge_kutta_dopri5<State>());
    const State v = one.velocity();
    stepper.initialize(State{one.x, one.y}, 0.0, 1e-2);
    State at{};
    for (double t = 0.0; t < one.t_end;) {
        stepper.do_step([&](const State&, State& rate, double) { rate = v; });
        t = std::min(stepper.current_time(), one.t_end);
        stepper.calc_state(t, at);
        if (one.gap(at[0], at[1]) <= 0.0)
            return true;
    }
    return false;
}

int rate_of(double, N_Vector, N_Vector rate, void* data) {
    const State v = static_cast<const Encounter*>(data)->velocity();
    std::copy(v.begin(), v.end(), N_VGetArrayPointer(rate));
    return 0;
}

int gap_of(double, N_Vector y, double* gap, void* data) {
    const double* const at = N_VGetArrayPointer(y);
    *gap = static_cast<const Encounter*>(data)->gap(at[0], at[1]);
    return 0;
}

void require(int flag) {
    if (flag < 0)
        throw std::runtime_error("CVODES: " + std::to_string(flag));
}

bool cvodes_meets(Encounter one, double rtol, SUNContext context) {
    N_Vector y = N_VNew_Serial(2, context);
    N_VGetArrayPointer(y)[0] = one.x;
    N_VGetArrayPointer(y)[1] = one.y;
    void* solver = CVodeCreate(CV_ADAMS, context);
    require(CVodeInit(solver, rate_of, 0.0, y));
    require(CVodeSStolerances(solver, rtol, rtol));
    require(CVodeSetUserData(solver, &one));
    require(CVodeSetMaxNumSteps(solver, 100'000));
    SUNNonlinearSolver iteration = SUNNonlinSol_FixedPoint(y, 0, context);
    require(CVodeSetNonlinearSolver(solver, iteration));
    require(CVodeRootInit(solver, 1, gap_of));
    double t = 0.0;
    const int flag = CVode(solver, one.t_end, y, &t, CV_NORMAL);
    require(flag);
    CVodeFree(&solver);
    SUNNonlinSolFree(iteration);
    N_VDestroy(y);
    return flag == CV_ROOT_RETURN;
}

} // namespace

int main(int count, char** arguments) try {
    if (count != 2)
        throw std::runtime_error("usage: bench_grazing POINTS.csv");
    std::ifstream file(arguments[1]);
    SUNContext context = nullptr;
    require(SUNContext_Create(nullptr, &context));
    for (std::string line; std::getline(file, line);) {
        std::ranges::replace(line, ',', ' ');
        std::istringstream row(line);
        Encounter one{};
        if (!(row >> one.x >> one.y >> one.first >> one.second >> one.contact >> one.t_end))
            continue; // the line of names
        std::printf("%d %d %d %d\n", cvodes_meets(one, 1e-6, context), cvodes_meets(one, 1e-10, context),
                    dopri5_meets(one, 1e-6), dopri5_meets(one, 1e-10));
    }
    SUNContext_Free(&context);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
