#include "rodwake/fitting/density.hpp"

#include "prior_map.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <new>
#include <numeric>

namespace rodwake::fitting {

Density::Density(const Problem& problem, const std::vector<Prior>& priors)
    : problem_(problem), free_(free_parameters(problem)),
      constant_(-static_cast<double>(problem.residuals) * log_root_2pi -
                std::accumulate(problem.log_sigma.begin(), problem.log_sigma.end(), 0.0)) {
    if (priors.size() != free_.size())
        throw InputError(
            fmt::format("posterior: {} priors for {} free parameters", priors.size(), free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k)
        maps_.emplace_back(priors[k], problem.parameters[free_[k]].name);
}

Density::~Density() = default;

double Density::log_prior(std::span<const double> free) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < maps_.size(); ++k)
        sum += maps_[k].log_density(free[k]);
    return sum;
}

double Density::log_likelihood(std::span<const double> free) const {
    return log_likelihood_of(residuals_of(free));
}

std::vector<double> Density::log_likelihoods(std::span<const double> free) const {
    const Eigen::VectorXd r = residuals_of(free);
    std::vector<double> out(problem_.residuals, -HUGE_VAL);
    for (std::size_t i = 0; i < static_cast<std::size_t>(r.size()); ++i) {
        const double one = r[static_cast<Eigen::Index>(i)];
        out[i] = -0.5 * one * one - log_root_2pi - (problem_.log_sigma.empty() ? 0.0 : problem_.log_sigma[i]);
    }
    return out;
}

std::vector<double> Density::values(const Eigen::VectorXd& z) const {
    std::vector<double> out(maps_.size());
    for (std::size_t k = 0; k < maps_.size(); ++k)
        out[k] = maps_[k].value(z[static_cast<Eigen::Index>(k)]);
    return out;
}

Eigen::VectorXd Density::coordinates(std::span<const double> all) const {
    Eigen::VectorXd z(size());
    for (std::size_t k = 0; k < maps_.size(); ++k)
        z[static_cast<Eigen::Index>(k)] = maps_[k].coordinate(all[free_[k]]);
    return z;
}

Eigen::VectorXd Density::residuals(const Eigen::VectorXd& z) const { return residuals_of(values(z)); }

double Density::at(const Eigen::VectorXd& z) const {
    const double value = log_likelihood_of(residuals(z)) + log_prior_at(z);
    return std::isfinite(value) ? value : -HUGE_VAL;
}

double Density::log_prior_at(const Eigen::VectorXd& z) const {
    return -0.5 * z.squaredNorm() - static_cast<double>(size()) * log_root_2pi;
}

Eigen::VectorXd Density::residuals_of(std::span<const double> free) const {
    Eigen::VectorXd r = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem_.residuals));
    try {
        problem_.evaluate(all_values(problem_, free), r, nullptr);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) { // a place without a model, as in a search
        return {};
    }
    return r.allFinite() ? r : Eigen::VectorXd();
}

double Density::log_likelihood_of(const Eigen::VectorXd& residuals) const {
    return residuals.size() == 0 ? -HUGE_VAL : constant_ - 0.5 * residuals.squaredNorm();
}

} // namespace rodwake::fitting
