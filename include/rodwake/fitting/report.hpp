#pragma once
// What a fit says, and how well: errors, correlations, directions the data do not fix, bounds reached.
//
// Errors come from the curvature at the minimum, C = (J^T J)^-1 in the coordinates of the search (Transform),
// by a singular value decomposition of J with columns scaled to unit length. Singular values below
// `rank_tolerance` of the largest make a flat direction: the error of every parameter in it is infinite
// (said), not a large number. A parameter held by a bound has no error; its interval reaches from the bound
// to where the profile likelihood has risen by 3.84, at most to the other bound.

#include "rodwake/core/estimate.hpp"
#include "rodwake/fitting/fit.hpp"

#include <map>
#include <optional>

namespace rodwake::fitting {

struct ParameterEstimate {
    std::string name;
    double value = 0.0;
    double standard_error = 0.0; ///< standard error of the value; infinite: not fixed by the data, or not
                                 ///< known (Report::error_factor infinite); 0: fixed
    double low = 0.0,
           high = 0.0; ///< 95 % interval from the curvature; log parameters: symmetric in the logarithm
    bool free = true, at_lower = false, at_upper = false;
    std::string tied_to;
    double tie_factor = 1.0;
};
using Estimate [[deprecated("it is ParameterEstimate")]] = ParameterEstimate;

/// A combination of parameters that changes the residuals hardly or not at all.
struct FlatDirection {
    double singular_value = 0.0; ///< relative to the largest
    std::vector<double> change;  ///< of all parameters; relative change for log parameters; largest = 1
    std::string text;            ///< "the data fix neither f_over_mu nor xi: +1 % of ..."
};

struct Report {
    std::vector<ParameterEstimate> estimates; ///< of all parameters
    std::vector<std::size_t> free;            ///< parameters the matrices below are about
    Eigen::MatrixXd covariance; ///< of the values, linearised; flat: infinite on the diagonal, 0 beside it
    Eigen::MatrixXd root,
        null_space; ///< covariance without its infinite part = root root^T; flat directions (columns)
    Eigen::MatrixXd correlation; ///< unit diagonal; NaN-free: 0 where an error is infinite or a bound holds
    double chi2 = 0.0;
    long dof = 0; ///< independent values less free parameters, be they on a bound or in a flat direction
    double probability = 1.0;  ///< of so large a chi2 if model and sigmas are right
    double error_factor = 1.0; ///< what the errors were multiplied by (sigma_known = false: sqrt(chi2/dof);
                               ///< robust losses: Huber's factor from the scatter of the residuals);
                               ///< infinite: no error is known (dof <= 0, or no finite residuals)
    long rank = 0;             ///< of J
    std::vector<FlatDirection> flat; ///< exactly flat and nearly flat ones (singular value below 1e-3)
    std::vector<std::string>
        diagnostics; ///< bounds, flatness, poor chi2, other minima nearly as good, in words
    std::size_t same_optimum =
        0; ///< starts that ended within 1e-4 (relative, plus 1e-8) of the best objective
};

struct ReportOptions {
    double rank_tolerance = 1e-10;
};

Report report(const Problem& problem, const Fit& fit, const ReportOptions& options = {});

/// Model uncertainty: standard error of linear functions of the parameters, given their gradients (rows:
/// functions, columns: all parameters): sqrt(g C g^T). Infinite for functions that change along a flat
/// direction.
Eigen::VectorXd propagated(const Report& report, const Eigen::MatrixXd& gradients);

/// Whether the estimate, or the one it is tied to, is held by a bound.
bool at_bound(const Report& report, const ParameterEstimate& estimate);
/// Whether it has a standard error, if an infinite or unknown one: neither fixed nor held by a bound.
bool has_error(const Report& report, const ParameterEstimate& estimate);

/// Value of a parameter, if the fit has it.
std::optional<double> fitted_value(const Report& report, const std::string& name);

/// A function of the parameters, its derivatives by name, and the error that follows: infinite if it changes
/// along a flat direction; unknown if no error is known (Report::error_factor), if it follows from fixed
/// values alone or from one that is held by a bound.
rodwake::Estimate derived(const Report& report, double value, const std::map<std::string, double>& gradient);

/// Report as a page of text: table of estimates, correlations, chi2, starts, diagnostics.
std::string to_text(const Problem& problem, const Fit& fit, const Report& report);

/// Profile likelihood: the smallest chi2 over the other free parameters as one is moved.
struct ProfileLikelihood {
    std::size_t parameter = 0;
    std::vector<double> value, chi2; ///< increasing value; chi2 as the loss
    std::optional<double> low,
        high; ///< where chi2 rises by 3.841459 (95 %, one parameter; scaled as the errors); empty: not within
              ///< the bounds or 1000 standard errors: unbounded on that side
};
ProfileLikelihood profile_likelihood(const Problem& problem, const Method& method, const Fit& best,
                                     std::size_t parameter, std::size_t points = 25);

/// Of a parameter that is held by a bound: where chi2 has risen as much on the free side; empty: nowhere up
/// to the other bound.
std::optional<double> one_sided_limit(const Problem& problem, const Fit& best, std::size_t parameter);

} // namespace rodwake::fitting
