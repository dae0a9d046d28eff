#pragma once
// Several multivariate t distributions of five degrees of freedom, which stand for a posterior: heavier in
// the tails, so that ratios of the posterior to them stay bounded.

#include "rodwake/core/rng.hpp"

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rodwake::fitting {

Eigen::VectorXd normal_draws(RandomStream& random, Eigen::Index size);

class Mixture {
public:
    struct Part {
        double weight = 1.0;
        Eigen::VectorXd middle;
        Eigen::MatrixXd covariance; ///< of what it stands for; positive definite
    };

    explicit Mixture(std::vector<Part> parts);
    /// From what numbers() gave.
    Mixture(std::span<const double> numbers, Eigen::Index size);

    std::size_t parts() const { return parts_.size(); }
    /// From a normal distribution about a part, this many times as wide.
    Eigen::VectorXd about(std::size_t part, double wide, RandomStream& random) const;
    double log_density(const Eigen::VectorXd& z) const;
    Eigen::VectorXd draw(RandomStream& random) const;
    /// L with L L^T the mean covariance of the parts.
    Eigen::MatrixXd common_root() const;
    /// Moved by this share towards what these places say; each place is that of the part it is likeliest in.
    Mixture learned(const std::vector<Eigen::VectorXd>& places, double share) const;

    std::vector<double> numbers() const;

private:
    double log_density(std::size_t part, const Eigen::VectorXd& z) const;
    std::size_t nearest(const Eigen::VectorXd& z) const;
    void settle();

    std::vector<Part> parts_;
    std::vector<Eigen::MatrixXd> roots_;
    std::vector<double> constants_; ///< logarithms of weight and normalisation
};

} // namespace rodwake::fitting
