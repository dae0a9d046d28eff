// What each solver flag usually means and what to do about it. tests/integrate provokes the reachable ones.

#include "describe_failure.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace rodwake::integrate {

namespace {

struct Entry {
    std::string_view flag;
    Remedy remedy;
};

constexpr const char* look_at_rhs =
    "check the model at that time and state; set max_step if it is only defined near the solution";

constexpr std::array entries{
    Entry{"TOO_MUCH_WORK",
          {"the steps allowed were used up", "raise max_steps, loosen rtol, or use method bdf if the "
                                             "problem is stiff"}},
    Entry{"TOO_MUCH_ACC",
          {"the tolerances ask for more digits than the arithmetic has", "loosen rtol or raise atol"}},
    Entry{"ERR_FAILURE",
          {"no step was short enough for the tolerances: the right-hand side jumps or is singular here",
           "raise atol for the components named, loosen rtol, or stop earlier by an event (a larger "
           "contact distance)"}},
    Entry{"CONV_FAILURE",
          {"the implicit equation of the step did not converge: stiff problem, or a wrong Jacobian",
           "use method bdf, check the Jacobian against difference quotients, or tighten rtol"}},
    Entry{"LSETUP_FAIL", {"the Jacobian could not be set up", "check the Jacobian at that time"}},
    Entry{"LSOLVE_FAIL",
          {"the linear system of the step could not be solved", "check the Jacobian at that time"}},
    Entry{"RHSFUNC_FAIL", {"the right-hand side failed", look_at_rhs}},
    Entry{"FIRST_RHSFUNC_ERR", {"the right-hand side failed at the start", "check the initial state"}},
    Entry{"REPTD_RHSFUNC_ERR", {"the right-hand side kept failing however short the step", look_at_rhs}},
    Entry{"UNREC_RHSFUNC_ERR", {"the right-hand side kept failing however short the step", look_at_rhs}},
    Entry{"SRHSFUNC_FAIL", {"the derivatives of the right-hand side failed", look_at_rhs}},
    Entry{"FIRST_SRHSFUNC_ERR",
          {"the derivatives of the right-hand side failed at the start", "check the initial state"}},
    Entry{"REPTD_SRHSFUNC_ERR",
          {"the derivatives of the right-hand side kept failing however short the step", look_at_rhs}},
    Entry{"UNREC_SRHSFUNC_ERR",
          {"the derivatives of the right-hand side kept failing however short the step", look_at_rhs}},
    Entry{"RTFUNC_FAIL", {"an event function failed", "check the event function at that time"}},
    Entry{"STEP_BELOW_ROUNDOFF",
          {"the step no longer changes the time: the solution is singular here",
           "loosen rtol, or stop earlier by an event (a larger contact distance)"}},
};

} // namespace

Remedy remedy_for(const std::string& flag) {
    const auto entry =
        std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.flag == flag; });
    if (entry != entries.end())
        return entry->remedy;
    return {nullptr, "try another method, or loosen rtol"};
}

} // namespace rodwake::integrate
