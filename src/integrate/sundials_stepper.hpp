#pragma once
// What the steppers of SUNDIALS share: vectors, the problem's functions as callbacks, error texts.

#include "stepper.hpp"
#include "sundials_raii.hpp"

namespace rodwake::integrate {

class SundialsStepper : public Stepper {
public:
    SundialsStepper(UserFunctions& calls, const OdeOptions& options, double end_time);

    State state_before() const final { return sundials::elements(before_.get()); }
    State state() const final { return sundials::elements(after_.get()); }

protected:
    void set_start(double t, State y);
    // The problem's functions as SUNDIALS calls them; the user data are the UserFunctions.
    static int rhs_callback(double t, N_Vector y, N_Vector ydot, void* calls);
    static int error_weights_callback(N_Vector y, N_Vector weights, void* calls);
    /// Error over tolerance of each component, from the weights and errors that an integrator hands out.
    using Getter = int (*)(void* memory, N_Vector);
    std::vector<double> products(void* memory, Getter a, Getter b) const;
    static void keep_text(int flag, const char* module, const char* function, char* text, void* stepper);

    sundials::Context context_ = sundials::make_context();
    sundials::Vector before_, after_;
    sundials::Vector view_; ///< wraps a caller's array
};

} // namespace rodwake::integrate
