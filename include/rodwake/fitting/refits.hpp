#pragma once
// Errors that the curvature does not know of, from fitting again: constants that were held at values with
// errors of their own, other choices of data, runs left out one by one.
//
//   held constant c +- s     change of p = [p(c + s) - p(c - s)]/2, the error it adds
//   choices of data (masks)  standard deviation of p over the choices
//   runs (jackknife)         var p = sum over groups h of (n_h - 1)/n_h sum_i (p_hi - mean_h)^2, p_hi without
//                            run i of group h (Efron, The Jackknife, the Bootstrap and Other Resampling
//                            Plans, SIAM 1982, stratified); needs no independence of the data within a run
//
// All refits begin at the best values, with the problem's own method but a single local search. Errors of
// held constants are taken to be independent of each other and of the data.

#include "rodwake/fitting/report.hpp"

namespace rodwake::fitting {

/// The same search from these values. Fixed parameters stay at their start.
Fit refit(const Problem& problem, const Method& method, std::span<const double> from);

struct HeldConstant {
    std::size_t parameter = 0; ///< a fixed one
    double error = 0.0;        ///< of its value, > 0
};

/// Change of every parameter for one standard error of the constant. Throws InputError for a parameter that
/// is not fixed or an error that is not above 0, RunError where a refit fails, as it does where the model
/// does not exist within the error. `remake`: the problem with these parameters, as problems may have worked
/// out what is fixed.
std::vector<double> change_with(const std::function<Problem(const std::vector<Parameter>&)>& remake,
                                const std::vector<Parameter>& parameters, const Method& method,
                                std::span<const double> best, const HeldConstant& held);

/// Standard deviation over choices, (n - 1) in the denominator; `values`: [choice][parameter], two or more.
std::vector<double> spread(const std::vector<std::vector<double>>& values);

/// Standard errors from values without one run: [group][left-out run][parameter], two runs or more a group.
std::vector<double> jackknife_error(const std::vector<std::vector<std::vector<double>>>& values);

} // namespace rodwake::fitting
