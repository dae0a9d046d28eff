#pragma once
// Least squares: how the minimum is searched.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace rodwake::fitting {

/// Of NLopt. The first two need no derivatives, the next three use the gradient, the last four search the
/// whole box of the bounds (every free parameter needs both) and hand over to a local one (mlsl: inside).
enum class Algorithm { bobyqa, nelder_mead, slsqp, lbfgs, mma, mlsl, crs, isres, direct_l };

bool needs_gradient(Algorithm algorithm);
constexpr bool is_global(Algorithm algorithm) {
    using enum Algorithm;
    return algorithm == mlsl || algorithm == crs || algorithm == isres || algorithm == direct_l;
}
std::string to_string(Algorithm algorithm); ///< "bobyqa", "nelder-mead", "slsqp", "lbfgs", "mma", "mlsl",
                                            ///< "crs", "isres", "direct-l"

/// squares: sum r^2. huber: linear beyond loss_width. cauchy: w^2 ln(1 + (r/w)^2).
enum class Loss { squares, huber, cauchy };

/// Where one start ended. Everything a later run needs to leave it out.
struct StartResult {
    std::size_t index = 0;
    std::vector<double> start, end; ///< of the free parameters
    double objective = 0.0;         ///< the loss at the end (chi2 with Loss::squares); infinite: failed
    std::string termination;        ///< in words
    long evaluations = 0;
};

/// What is searched and how far; plain numbers, which scenes hold as they are.
struct SearchOptions {
    Algorithm algorithm = Algorithm::slsqp;
    Loss loss = Loss::squares;
    double loss_width = 1.5;     ///< in sigma
    double tolerance = 1e-10;    ///< relative, of parameters and objective, of the NLopt stage
    long max_evaluations = 2000; ///< of the NLopt stage of each start
    /// Levenberg-Marquardt from where NLopt ended, to a stationary point. With a local algorithm another one
    /// begins at the start itself: the better end is taken, and StartResult says which. Evaluations count
    /// both.
    bool levenberg_marquardt = true;
    std::size_t starts = 1; ///< the first from Parameter::start, the others spread around it
    /// Log parameters: start times a factor in [1/spread, spread], even in the logarithm. Linear ones: the
    /// same if start is not 0, with the other sign in half of the starts where the bounds allow both; else
    /// anywhere between the bounds, or within spread scales of 0 without bounds. Always within the bounds.
    double spread = 10.0;
    std::uint64_t seed = 1; ///< of the starts and of the random searches

    bool operator==(const SearchOptions&) const = default;
};

struct Method : SearchOptions {
    std::size_t threads = 1; ///< starts run in parallel; the result does not depend on it
    std::vector<StartResult> done =
        {}; ///< starts of an earlier, interrupted run of the same problem and method
    std::function<void(const StartResult&)> on_start_done = {}; ///< one at a time, in any order
    std::function<bool()> stop_requested = {}; ///< polled at each evaluation; true: best so far is kept
};

} // namespace rodwake::fitting
