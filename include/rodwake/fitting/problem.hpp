#pragma once
// Least squares: what is to be fitted. Problem (this), method (method.hpp), fit and report (report.hpp) are
// three types; none knows what the residuals mean.
//
//   chi2(p) = sum_i r_i(p)^2,   r_i = (model_i(p) - data_i)/sigma_i

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace rodwake::fitting {

/// In which coordinate a parameter is searched and its errors are symmetric.
enum class Transform { linear, log };

/// log: value, start and bounds above 0.
struct Parameter {
    std::string name = {};
    double start = 0.0;
    double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
    Transform transform = Transform::linear;
    double scale =
        0.0; ///< size of a natural step in the coordinate of the search; 0: chosen from start and bounds
    bool fixed = false; ///< stays at start
    std::string tied_to =
        {}; ///< name of a free parameter: value = tie_factor times its value; empty: not tied
    double tie_factor = 1.0;
    bool spreads = true; ///< false: every search begins at `start`, which is a datum

    bool free() const { return !fixed && tied_to.empty(); }
};

/// Residuals of one quantity of one set of data, in the order of place or time.
struct Series {
    std::string data, quantity; ///< "pair", "headings"
    std::vector<std::size_t> residuals;
};

struct Problem {
    std::vector<Parameter> parameters; ///< in the order of `p` below
    std::size_t residuals = 0;
    /// Residuals at p (all parameters, free or not), and if `jacobian` is not null d r_i/d p_j (residuals x
    /// parameters; columns of fixed parameters may be left zero). Must be safe to call from several threads.
    /// May throw or give values that are not finite: the place then counts as infinitely bad.
    std::function<void(std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian)>
        evaluate;
    /// False: the sigmas are relative, the errors are scaled by sqrt(chi2/dof).
    bool sigma_known = true;
    /// Independent values behind one residual, in (0, 1]; below 1 if neighbouring data share data. The
    /// degrees of freedom are independent * residuals - free parameters; the sigmas are enlarged by
    /// 1/sqrt(independent) already, so chi2 is to be compared with that number.
    double independent = 1.0;
    /// Of each residual, for the normalisation of the likelihood; empty: of sigma 1.
    std::vector<double> log_sigma = {};
    /// What residual i is, for messages: "profile_Ux_x.csv:17".
    std::function<std::string(std::size_t)> residual_name;
    std::vector<Series> series = {}; ///< of all residuals; empty: they are one
    /// What looks wrong in the data, in sentences: the report begins with it.
    std::vector<std::string> remarks = {};
};

/// Throws InputError, naming what is wrong: no or duplicate names, reversed bounds, start outside its bounds,
/// log of what is not positive, a tie to what is not free, fewer residuals than free parameters.
void validate(const Problem& problem);

/// Those of the problem, or one of all residuals.
std::vector<Series> series_of(const Problem& problem);

/// Independent values behind all residuals, rounded.
long independent_values(const Problem& problem);

/// Independent values less the number of free parameters. Those that end on a bound or that the data do not
/// fix count too: they were fitted.
long degrees_of_freedom(const Problem& problem);

/// Indices of the free parameters.
std::vector<std::size_t> free_parameters(const Problem& problem);

/// All parameters from the values of the free ones: fixed ones at their start, ties followed.
std::vector<double> all_values(const Problem& problem, std::span<const double> free);

} // namespace rodwake::fitting
