#pragma once
// Probability density of the free parameters of a problem, given its data and priors, all constants in it:
//
//   log p(values) = -chi2/2 - sum log(sigma sqrt(2 pi)) + log prior
//
// as a function of the values, or of z, in which each prior is standard normal: z = Phi^-1(F(value)) with F
// the prior's distribution function. There no bound is left and all parameters are of order 1.

#include "rodwake/fitting/prior.hpp"
#include "rodwake/fitting/problem.hpp"

#include <memory>

namespace rodwake::fitting {

class PriorMap;

class Density {
public:
    /// Of the problem, which must outlive it, and a prior for each free parameter. Throws InputError for one
    /// that is improper.
    Density(const Problem& problem, const std::vector<Prior>& priors);
    ~Density();
    Density(const Density&) = delete;
    Density& operator=(const Density&) = delete;
    Density(Density&&) = delete;
    Density& operator=(Density&&) = delete;

    Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }

    // By the values of the free parameters; -infinity where the prior or the model does not exist.

    double log_prior(std::span<const double> free) const;
    double log_likelihood(std::span<const double> free) const;
    /// Of each residual.
    std::vector<double> log_likelihoods(std::span<const double> free) const;

    // By z.

    std::vector<double> values(const Eigen::VectorXd& z) const;
    /// From the values of all parameters.
    Eigen::VectorXd coordinates(std::span<const double> all) const;
    /// Empty where the model does not exist.
    Eigen::VectorXd residuals(const Eigen::VectorXd& z) const;
    double at(const Eigen::VectorXd& z) const;
    double log_prior_at(const Eigen::VectorXd& z) const;

private:
    Eigen::VectorXd residuals_of(std::span<const double> free) const;
    double log_likelihood_of(const Eigen::VectorXd& residuals) const;

    const Problem& problem_;
    std::vector<std::size_t> free_;
    std::vector<PriorMap> maps_;
    double constant_; ///< of the likelihood
};

} // namespace rodwake::fitting
