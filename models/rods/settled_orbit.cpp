#include "rodwake/rods/settled_orbit.hpp"

#include "pair_reduced.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rodwake::rods {

namespace {

constexpr std::size_t directions = 96;
// Only rods within some hundredths of an orbit can be decided, and Newton's first step from there is about as
// long. Most pairs are far from any orbit, and one evaluation of the flow shows that.
constexpr double longest_first_step = 1.0;
constexpr double sizes[] = {1.0, 0.75, 0.5, 0.25}; // rods too far fail at the largest

/// Direction k, evenly over the sphere (a Fibonacci lattice).
Eigen::Vector3d on_sphere(std::size_t k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / directions;
    const double angle = static_cast<double>(k) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double across = std::sqrt(1.0 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
}

} // namespace

Pose pose_seen_from(const Pose& from, const Pose& rod) {
    const double c = std::cos(from.heading), s = std::sin(from.heading);
    const double x = rod.x - from.x, y = rod.y - from.y;
    return {c * x + s * y, c * y - s * x, std::remainder(rod.heading - from.heading, 2.0 * std::numbers::pi)};
}

std::optional<SettledOrbit> settled_orbit(const elastic::Medium& medium, const Couplings& couplings,
                                          const Pose& rod0, const Pose& rod1,
                                          std::optional<double> contact_distance, std::string* failed) {
    const auto fail = [&](std::string words) -> std::optional<SettledOrbit> {
        if (failed)
            *failed = std::move(words);
        return {};
    };
    const Pose now = pose_seen_from(rod0, rod1);
    const auto orbit = equilibrium_near(medium, couplings, now, longest_first_step);
    if (!orbit || orbit->kind != EquilibriumKind::orbit)
        return fail("Newton's method finds none near here");
    if (!orbit->stable())
        return fail(fmt::format("that of separation {:.4g} is unstable, with an eigenvalue of {:.3g}",
                                orbit->separation[0], orbit->eigenvalues[0].real()));
    if (contact_distance && orbit->separation[0] <= *contact_distance)
        return fail(fmt::format("that of separation {:.4g} is within the contact distance, {:g}",
                                orbit->separation[0], *contact_distance));
    // In units of xi; d is measured by the separation.
    const ScaledPair pair(medium, couplings);
    const double r = orbit->separation[0] / pair.xi;
    const Eigen::Vector3d scale{r, r, 1.0};
    const Pose& q = orbit->pose;
    const Pose centre{q.x / pair.xi, q.y / pair.xi, q.heading};
    const Eigen::Vector3d d{(now.x - q.x) / orbit->separation[0], (now.y - q.y) / orbit->separation[0],
                            std::remainder(now.heading - q.heading, 2.0 * std::numbers::pi)};
    const Eigen::Matrix3d J =
        scale.cwiseInverse().asDiagonal() * flow_at(pair, centre).by_pose * scale.asDiagonal();
    // V = d^T P d with P = T^-H T^-1, which is real, since complex eigenvectors come in pairs.
    const Eigen::EigenSolver<Eigen::Matrix3d> modes(J);
    const Eigen::Matrix3cd to_modes = modes.eigenvectors().inverse();
    const Eigen::Matrix3d P = (to_modes.adjoint() * to_modes).real();
    const Eigen::LLT<Eigen::Matrix3d> root(P);
    const auto too_far = [&] {
        return fail(fmt::format("that of separation {:.4g} is {:.3g} away, in separations and rad: not known "
                                "to lead there",
                                orbit->separation[0], d.norm()));
    };
    if (root.info() != Eigen::Success)
        return too_far();
    const double slowest = -modes.eigenvalues().real().maxCoeff();
    // The surface of V = s^2 V(q) is s |L^T d| L^-T e, with P = L L^T and e a unit vector.
    // Nearer than 1e-6 rates are rounding, and the flow is linear.
    const double radius = std::max(1e-6, (root.matrixL().transpose() * d).norm());
    for (const double size : sizes)
        for (std::size_t k = 0; k < directions; ++k) {
            const Eigen::Vector3d e = size * radius * root.matrixU().solve(on_sphere(k));
            const Pose sample{centre.x + r * e[0], centre.y + r * e[1], centre.heading + e[2]};
            const double separation = std::hypot(sample.x, sample.y);
            if (!(separation > 0.1 * r) || (contact_distance && separation * pair.xi <= *contact_distance))
                return too_far();
            const Eigen::Vector3d rates = scale.cwiseInverse().asDiagonal() * rates_at(pair, sample);
            if (!(2.0 * e.dot(P * rates) <= -slowest * e.dot(P * e)))
                return too_far();
        }
    return SettledOrbit{*orbit, -orbit->eigenvalues[0].real(), d.norm()};
}

} // namespace rodwake::rods
