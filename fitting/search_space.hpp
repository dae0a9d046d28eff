#pragma once
// Coordinates of the search: u = value/scale, or log(value)/scale, of the free parameters. Bounds are kept
// exactly: a u on a bound gives the bound's own value.

#include "rodwake/fitting/method.hpp"
#include "rodwake/fitting/problem.hpp"

namespace rodwake::fitting {

inline constexpr double infinite =
    std::numeric_limits<double>::infinity(); // bounds and errors of what is open

class SearchSpace {
public:
    explicit SearchSpace(const Problem& problem);

    Eigen::Index size() const { return static_cast<Eigen::Index>(free.size()); }

    /// From values of the free parameters.
    Eigen::VectorXd coordinates(std::span<const double> free_values) const;
    std::vector<double> free_values(const Eigen::VectorXd& u) const;
    /// Of all parameters.
    std::vector<double> values(const Eigen::VectorXd& u) const;
    double value(Eigen::Index k, double u) const;
    double coordinate(Eigen::Index k, double value) const;
    /// d value_k / d u_k.
    double slope(Eigen::Index k, double value) const;
    /// Derivatives in u from derivatives in all values: ties add to what they are tied to.
    Eigen::MatrixXd chain(const Eigen::MatrixXd& in_values, std::span<const double> values) const;
    bool logarithmic(Eigen::Index k) const;
    /// False if nothing tells the size of the parameter.
    bool scale_known(Eigen::Index k) const;
    Eigen::VectorXd clamp(const Eigen::VectorXd& u) const { return u.cwiseMax(lower).cwiseMin(upper); }

    std::vector<std::size_t> free; ///< indices in Problem::parameters
    Eigen::VectorXd lower, upper;

private:
    struct TiedValue {
        std::size_t parameter;
        Eigen::Index to; ///< among the free ones
        double factor;
    };
    const Parameter& parameter(Eigen::Index k) const { return problem_->parameters[free[k]]; }

    const Problem* problem_;
    std::vector<TiedValue> ties_;
    Eigen::VectorXd scale_;
};

/// Parameter::scale, or what stands for it: 1 in the logarithm, else |start|, a tenth of the bounds'
/// distance, 1.
double natural_scale(const Parameter& parameter);

/// Where the searches begin: values of the free parameters for start `index`, as Method::spread says; depends
/// on the seed and index only.
std::vector<double> start_values(const Problem& problem, const Method& method, std::size_t index);

} // namespace rodwake::fitting
