#pragma once
// The search itself: the best of all starts, as a value. Never throws for a search that fails.

#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/problem.hpp"

namespace rodwake::fitting {

enum class Termination {
    converged,   ///< stationary: Levenberg-Marquardt (or the NLopt stage without it) met its tolerance
    roundoff,    ///< no further progress possible in double precision; the best point is kept
    budget,      ///< max_evaluations spent first
    interrupted, ///< stop_requested
    failed       ///< nowhere a finite residual vector
};
std::string to_string(Termination termination);

struct Fit {
    std::vector<double> values; ///< of all parameters
    double objective = 0.0;     ///< of the loss
    Loss loss = Loss::squares;  ///< as in the method: the report's errors depend on it
    double loss_width = 1.5;
    double chi2 = 0.0; ///< sum r^2 whatever the loss
    Termination termination = Termination::failed;
    std::string reason; ///< in words: what NLopt and Levenberg-Marquardt said
    /// Norm of the gradient of chi2/2 projected on the free parameters not held by a bound, each scaled by
    /// its standard error; dimensionless: below 1e-3 the minimum is closer than a thousandth of an error.
    double distance = 0.0;
    long evaluations = 0;            ///< of the residuals, all starts
    std::vector<StartResult> starts; ///< by index; termination is "converged: reason"
};

/// Throws InputError for a malformed problem or method only. Deterministic; independent of threads.
Fit fit(const Problem& problem, const Method& method);

} // namespace rodwake::fitting
