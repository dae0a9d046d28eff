#include "mixture.hpp"

#include "prior_map.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace rodwake::fitting {

namespace {

constexpr double freedom = 5.0;
constexpr std::size_t most_places = 2500;

} // namespace

Eigen::VectorXd normal_draws(RandomStream& random, Eigen::Index size) {
    Eigen::VectorXd out(size);
    for (double& value : out)
        value = normal_quantile(random.uniform());
    return out;
}

Mixture::Mixture(std::vector<MixtureComponent> parts) : parts_(std::move(parts)) {
    double all = 0.0;
    for (const MixtureComponent& part : parts_)
        all += part.weight;
    for (MixtureComponent& part : parts_)
        part.weight /= all;
    wide_ = {0.1, 0.0 * parts_.front().middle, 0.0 * parts_.front().covariance};
    for (const MixtureComponent& part : parts_)
        wide_.middle += part.weight * part.middle;
    for (const MixtureComponent& part : parts_) {
        const Eigen::VectorXd off = part.middle - wide_.middle;
        wide_.covariance += 3.0 * part.weight * (part.covariance + off * off.transpose());
    }
    const auto d = static_cast<double>(wide_.middle.size());
    for (std::size_t i = 0; i <= parts_.size(); ++i) {
        const double weight = i < parts_.size() ? (1.0 - wide_.weight) * parts_[i].weight : wide_.weight;
        Eigen::LLT<Eigen::MatrixXd> root(part(i).covariance);
        if (root.info() != Eigen::Success) { // but for rounding it is positive definite
            Eigen::MatrixXd wider = part(i).covariance;
            wider.diagonal().array() += 1e-14 * wider.trace();
            root.compute(wider);
        }
        roots_.emplace_back(root.matrixL());
        constants_.push_back(
            std::log(weight) + boost::math::lgamma(0.5 * (freedom + d)) - boost::math::lgamma(0.5 * freedom) -
            0.5 * d * std::log(freedom * std::numbers::pi) - roots_.back().diagonal().array().log().sum());
    }
}

double Mixture::log_density(std::size_t i, const Eigen::VectorXd& z) const {
    const Eigen::VectorXd u = roots_[i].triangularView<Eigen::Lower>().solve(z - part(i).middle);
    return constants_[i] -
           0.5 * (freedom + static_cast<double>(z.size())) * std::log1p(u.squaredNorm() / freedom);
}

double Mixture::log_density(const Eigen::VectorXd& z) const {
    double most = -HUGE_VAL, sum = 0.0;
    for (std::size_t i = 0; i <= parts_.size(); ++i) {
        const double one = log_density(i, z);
        sum = one > most ? sum * std::exp(most - one) + 1.0 : sum + std::exp(one - most);
        most = std::max(most, one);
    }
    return most + std::log(sum);
}

Eigen::VectorXd Mixture::about(std::size_t part, double wide, RandomStream& random) const {
    return parts_[part].middle + wide * (roots_[part] * normal_draws(random, parts_[part].middle.size()));
}

Eigen::VectorXd Mixture::draw(RandomStream& random) const {
    double rest = random.uniform() - wide_.weight;
    std::size_t i = rest < 0.0 ? parts_.size() : 0;
    for (rest /= 1.0 - wide_.weight; i + 1 < parts_.size() && rest >= parts_[i].weight; ++i)
        rest -= parts_[i].weight;
    const Eigen::VectorXd direction = normal_draws(random, wide_.middle.size());
    const double stretch =
        std::sqrt(normal_draws(random, static_cast<Eigen::Index>(freedom)).squaredNorm() / freedom);
    return part(i).middle + roots_[i] * direction / stretch;
}

Eigen::MatrixXd Mixture::common_root() const {
    Eigen::MatrixXd mean = 0.0 * parts_.front().covariance;
    for (const MixtureComponent& part : parts_)
        mean += part.weight * part.covariance;
    return mean.llt().matrixL();
}

Mixture Mixture::learned(const std::vector<Eigen::VectorXd>& positions, std::size_t splits) const {
    // Some positions, evenly spread, stand for all.
    std::vector<const Eigen::VectorXd*> some;
    const std::size_t chosen = std::min(most_places, positions.size());
    for (std::size_t i = 0; i < chosen; ++i)
        some.push_back(&positions[i * positions.size() / chosen]);
    const auto d = static_cast<double>(parts_.front().middle.size()),
               count = static_cast<double>(some.size());
    // of a criterion of Schwarz, with a fourth of the places for independent ones
    const double worth = 2.0 * (1.0 + d + 0.5 * d * (d + 1.0)) * std::log(count) / count;
    Mixture best = followed(some, 6);
    for (std::size_t i = 0; i < splits && best.parts() < most_parts; ++i) {
        // The heaviest part is split in two along its longest axis.
        constexpr double apart = 0.8; // of its standard deviation there
        std::vector<MixtureComponent> parts = best.parts_;
        MixtureComponent& heavy = *std::ranges::max_element(parts, {}, &MixtureComponent::weight);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(heavy.covariance);
        const Eigen::Index last = heavy.middle.size() - 1;
        const Eigen::VectorXd step =
            apart * std::sqrt(std::max(0.0, axes.eigenvalues()[last])) * axes.eigenvectors().col(last);
        heavy.weight *= 0.5;
        heavy.covariance -= step * step.transpose();
        MixtureComponent other = heavy;
        heavy.middle -= step, other.middle += step;
        parts.push_back(std::move(other));
        Mixture next = Mixture(std::move(parts)).followed(some, 6);
        if (next.mean_log_density(some) < best.mean_log_density(some) + worth)
            break;
        best = std::move(next);
    }
    return best;
}

/// Expectation and maximisation.
Mixture Mixture::followed(const Positions& positions, int rounds) const {
    std::vector<std::vector<double>> shares(parts_.size(), std::vector<double>(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const double all = log_density(*positions[i]);
        for (std::size_t k = 0; k < parts_.size(); ++k)
            shares[k][i] = std::exp(log_density(k, *positions[i]) - all);
    }
    std::vector<MixtureComponent> parts;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        // A part moves by the share that it has in each position. It is held to what it was by as many
        // positions as it has dimensions, so that a few do not make it flat.
        MixtureComponent& part = parts.emplace_back(parts_[k]);
        const auto hold = static_cast<double>(part.middle.size() + 1);
        const double count = std::accumulate(shares[k].begin(), shares[k].end(), 0.0);
        if (count >= 3.0 * hold) {
            Eigen::VectorXd middle = 0.0 * part.middle;
            for (std::size_t i = 0; i < positions.size(); ++i)
                middle += shares[k][i] / count * *positions[i];
            Eigen::MatrixXd found = 0.0 * part.covariance;
            for (std::size_t i = 0; i < positions.size(); ++i)
                found += shares[k][i] * (*positions[i] - middle) * (*positions[i] - middle).transpose();
            part.middle = middle;
            part.covariance = (found + hold * part.covariance) / (count + hold);
            part.covariance.diagonal().array() += 1e-14; // of positions that are all the same
        }

        // One that is not seen for a while is not given up.
        part.weight = count / static_cast<double>(positions.size());
        part.weight = std::max(part.weight, 0.2 / static_cast<double>(parts_.size()));
    }
    const Mixture next(std::move(parts));
    return rounds > 1 ? next.followed(positions, rounds - 1) : next;
}

double Mixture::mean_log_density(const Positions& positions) const {
    double sum = 0.0;
    for (const Eigen::VectorXd* z : positions)
        sum += log_density(*z);
    return sum / static_cast<double>(positions.size());
}

} // namespace rodwake::fitting
