#include "mixture.hpp"

#include "prior_map.hpp"

#include <Eigen/Cholesky>
#include <boost/math/special_functions/gamma.hpp>

#include <cmath>
#include <numbers>

namespace rodwake::fitting {

namespace {

constexpr double freedom = 5.0;
constexpr double least_weight = 0.05; ///< a part that is not seen for a while is not given up

Mixture::Part moved(Mixture::Part part, const std::vector<const Eigen::VectorXd*>& own, double share) {
    const auto count = static_cast<double>(own.size());
    if (count < 5.0 * static_cast<double>(part.middle.size() + 1))
        return part;
    Eigen::VectorXd middle = 0.0 * part.middle;
    for (const Eigen::VectorXd* z : own)
        middle += *z / count;
    Eigen::MatrixXd found = 0.0 * part.covariance;
    for (const Eigen::VectorXd* z : own)
        found += (*z - middle) * (*z - middle).transpose() / count;
    part.middle = middle;
    part.covariance = (1.0 - share) * part.covariance + share * found;
    part.covariance.diagonal().array() += 1e-14; // of places that are all the same
    return part;
}

} // namespace

Eigen::VectorXd normal_draws(RandomStream& random, Eigen::Index size) {
    Eigen::VectorXd out(size);
    for (double& one : out)
        one = normal_quantile(random.uniform());
    return out;
}

Mixture::Mixture(std::vector<Part> parts) : parts_(std::move(parts)) { settle(); }

Mixture::Mixture(std::span<const double> numbers, Eigen::Index size) {
    const auto each = static_cast<std::size_t>(1 + size + size * size);
    for (std::size_t at = 0; at + each <= numbers.size(); at += each)
        parts_.push_back({numbers[at], Eigen::Map<const Eigen::VectorXd>(&numbers[at + 1], size),
                          Eigen::Map<const Eigen::MatrixXd>(&numbers[at + 1 + static_cast<std::size_t>(size)],
                                                            size, size)});
    settle();
}

void Mixture::settle() {
    double all = 0.0;
    for (const Part& part : parts_)
        all += part.weight;
    for (Part& part : parts_) {
        part.weight /= all;
        roots_.emplace_back(part.covariance.llt().matrixL());
        const auto d = static_cast<double>(part.middle.size());
        constants_.push_back(std::log(part.weight) + boost::math::lgamma(0.5 * (freedom + d)) -
                             boost::math::lgamma(0.5 * freedom) -
                             0.5 * d * std::log(freedom * std::numbers::pi) -
                             roots_.back().diagonal().array().log().sum());
    }
}

double Mixture::log_density(std::size_t part, const Eigen::VectorXd& z) const {
    const Eigen::VectorXd u = roots_[part].triangularView<Eigen::Lower>().solve(z - parts_[part].middle);
    return constants_[part] -
           0.5 * (freedom + static_cast<double>(z.size())) * std::log1p(u.squaredNorm() / freedom);
}

double Mixture::log_density(const Eigen::VectorXd& z) const {
    double most = -HUGE_VAL, sum = 0.0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const double one = log_density(i, z);
        sum = one > most ? sum * std::exp(most - one) + 1.0 : sum + std::exp(one - most);
        most = std::max(most, one);
    }
    return most + std::log(sum);
}

std::size_t Mixture::nearest(const Eigen::VectorXd& z) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < parts_.size(); ++i)
        best = log_density(i, z) > log_density(best, z) ? i : best;
    return best;
}

Eigen::VectorXd Mixture::about(std::size_t part, double wide, RandomStream& random) const {
    return parts_[part].middle + wide * (roots_[part] * normal_draws(random, parts_[part].middle.size()));
}

Eigen::VectorXd Mixture::draw(RandomStream& random) const {
    double rest = random.uniform();
    std::size_t part = 0;
    while (part + 1 < parts_.size() && rest >= parts_[part].weight)
        rest -= parts_[part++].weight;
    const Eigen::VectorXd direction = normal_draws(random, parts_[part].middle.size());
    const double stretch =
        std::sqrt(normal_draws(random, static_cast<Eigen::Index>(freedom)).squaredNorm() / freedom);
    return parts_[part].middle + roots_[part] * direction / stretch;
}

Eigen::MatrixXd Mixture::common_root() const {
    Eigen::MatrixXd mean = 0.0 * parts_.front().covariance;
    for (const Part& part : parts_)
        mean += part.weight * part.covariance;
    return mean.llt().matrixL();
}

Mixture Mixture::learned(const std::vector<Eigen::VectorXd>& places, double share) const {
    std::vector<std::vector<const Eigen::VectorXd*>> own(parts_.size());
    for (const Eigen::VectorXd& z : places)
        own[nearest(z)].push_back(&z);
    std::vector<Part> parts;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        parts.push_back(moved(parts_[i], own[i], share));
        const double seen = static_cast<double>(own[i].size()) / static_cast<double>(places.size());
        parts.back().weight = std::max(least_weight, (1.0 - share) * parts_[i].weight + share * seen);
    }
    return Mixture(std::move(parts));
}

std::vector<double> Mixture::numbers() const {
    std::vector<double> out;
    for (const Part& part : parts_) {
        out.push_back(part.weight);
        out.insert(out.end(), part.middle.begin(), part.middle.end());
        out.insert(out.end(), part.covariance.data(), part.covariance.data() + part.covariance.size());
    }
    return out;
}

} // namespace rodwake::fitting
