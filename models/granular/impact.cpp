#include "rodwake/granular/impact.hpp"

#include "slip.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace rodwake::granular {

namespace {

Impact impact_of(const Eigen::Matrix3d& inverse_mass, const Eigen::Vector3d& velocity,
                 const Eigen::Vector3d& impulse) {
    return {impulse, velocity + product(inverse_mass, impulse)};
}

ContactTerms terms_of(const Eigen::Matrix3d& inverse_mass, const Surface& surface) {
    const double unit = 1.0 / inverse_mass(2, 2);
    return ContactTerms(unit * inverse_mass.topLeftCorner<2, 2>(), unit * inverse_mass.topRightCorner<2, 1>(),
                        surface);
}

} // namespace

namespace {

/// An impact that needs no path: none, or one without friction.
std::optional<Impact> plain_impact(const Eigen::Matrix3d& inverse_mass, const Eigen::Vector3d& velocity,
                                   const Surface& surface) {
    if (!(velocity.z() < 0.0))
        return Impact{Eigen::Vector3d::Zero(), velocity};
    if (surface.friction != 0.0)
        return std::nullopt;
    const double unit = -velocity.z() / inverse_mass(2, 2);
    return impact_of(inverse_mass, velocity, {0.0, 0.0, (1.0 + surface.restitution) * unit});
}

ImpactProgress start_of(const Eigen::Vector3d& velocity) {
    constexpr double fastest =
        1e150; // slip this fast keeps direction and speed to rounding; squares are finite
    ImpactProgress at;
    const double speed = velocity.head<2>().norm();
    if (speed > 0.0)
        at.direction = velocity.head<2>() / speed;
    at.speed = std::min(speed / -velocity.z(), fastest);
    return at;
}

Impact end_of(const ImpactProgress& at, const Eigen::Matrix3d& inverse_mass,
              const Eigen::Vector3d& velocity) {
    const double unit = -velocity.z() / inverse_mass(2, 2);
    return impact_of(
        inverse_mass, velocity,
        {unit * at.tangential_impulse.x(), unit * at.tangential_impulse.y(), unit * at.normal_impulse});
}

} // namespace

Impact stronge_impact(const Eigen::Matrix3d& inverse_mass, const Eigen::Vector3d& velocity,
                      const Surface& surface) {
    if (const auto plain = plain_impact(inverse_mass, velocity, surface))
        return *plain;
    ImpactProgress at = start_of(velocity);
    follow_impact(terms_of(inverse_mass, surface), at);
    return end_of(at, inverse_mass, velocity);
}

void stronge_impacts(std::span<const ImpactCase> cases, std::vector<Impact>& impacts) {
    std::vector<ContactTerms> terms;
    std::vector<ImpactProgress> paths;
    std::vector<std::size_t> followed;
    impacts.resize(cases.size());
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const auto& [inverse_mass, velocity, surface] = cases[i];
        if (const auto plain = plain_impact(inverse_mass, velocity, surface)) {
            impacts[i] = *plain;
            continue;
        }
        terms.push_back(terms_of(inverse_mass, surface));
        paths.push_back(start_of(velocity));
        followed.push_back(i);
    }
    follow_impacts(terms, paths);
    for (std::size_t k = 0; k < followed.size(); ++k) {
        const ImpactCase& one = cases[followed[k]];
        impacts[followed[k]] = end_of(paths[k], one.inverse_mass, one.velocity);
    }
}

Impact uncoupled_impact(double k_t, double k_n, const Eigen::Vector3d& velocity, const Surface& surface) {
    if (!(velocity.z() < 0.0))
        return {Eigen::Vector3d::Zero(), velocity};
    const double normal = -(1.0 + surface.restitution) * velocity.z() / k_n;
    const double speed = velocity.head<2>().norm();
    // Friction at its limit, or what stops the slip. Divided by the speed only where it is not 0.
    const double over_speed =
        surface.friction * normal * k_t < speed ? surface.friction * normal / speed : 1.0 / k_t;
    const Eigen::Vector3d impulse(-over_speed * velocity.x(), -over_speed * velocity.y(), normal);
    return {impulse, velocity + Eigen::Vector3d(k_t, k_t, k_n).cwiseProduct(impulse)};
}

} // namespace rodwake::granular
