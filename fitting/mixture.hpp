#pragma once
// Several multivariate t distributions of five degrees of freedom, which stand for a posterior: heavier in
// the tails, so that ratios of the posterior to them stay bounded.

#include "rodwake/core/rng.hpp"

#include <Eigen/Core>
#include <vector>

namespace rodwake::fitting {

Eigen::VectorXd normal_draws(RandomStream& random, Eigen::Index size);

inline constexpr std::size_t most_parts = 24;

class Mixture {
public:
    struct MixtureComponent {
        double weight = 1.0;
        Eigen::VectorXd middle;
        Eigen::MatrixXd covariance; ///< of what it stands for; positive definite
    };

    explicit Mixture(std::vector<MixtureComponent> parts);

    std::size_t parts() const { return parts_.size(); }
    /// From a normal distribution about a part, this many times as wide.
    Eigen::VectorXd about(std::size_t part, double wide, RandomStream& random) const;
    double log_density(const Eigen::VectorXd& z) const;
    Eigen::VectorXd draw(RandomStream& random) const;
    /// L with L L^T the mean covariance of the parts.
    Eigen::MatrixXd common_root() const;
    /// Fitted to these places; a part that does not follow them becomes two, this many times at most, so that
    /// bends are followed.
    Mixture learned(const std::vector<Eigen::VectorXd>& positions, std::size_t splits) const;

private:
    using Positions = std::vector<const Eigen::VectorXd*>;

    const MixtureComponent& part(std::size_t i) const { return i < parts_.size() ? parts_[i] : wide_; }
    double log_density(std::size_t i, const Eigen::VectorXd& z) const;
    double mean_log_density(const Positions& places) const;
    Mixture followed(const Positions& places, int rounds) const;

    std::vector<MixtureComponent> parts_;
    MixtureComponent
        wide_; ///< about all parts together, for places that they leave out; takes no part in learning
    std::vector<Eigen::MatrixXd> roots_;
    std::vector<double> constants_; ///< logarithms of weight and normalisation
};

} // namespace rodwake::fitting
