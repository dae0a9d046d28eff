#pragma once
// A solve that cannot go on, on its way from where it was noticed to the Status.

#include <string>

namespace rodwake::integrate {

struct StepFailure {
    std::string flag;  ///< without the solver's prefix: "RHSFUNC_FAIL"
    std::string cause; ///< empty: the usual cause of this flag
};

} // namespace rodwake::integrate
