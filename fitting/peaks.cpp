#include "chains.hpp"
#include "prior_map.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

struct Peak {
    Eigen::VectorXd z;
    Eigen::MatrixXd covariance;
    double log_mass = -HUGE_VAL; ///< of the Gaussian that the curvature makes; but for a constant
};

/// By central differences in z, which keeps ties and maps out of it; a step of 1e-4 where z is of order 1.
Eigen::MatrixXd slopes(const Density& density, const Eigen::VectorXd& z, Eigen::Index residuals) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(residuals, z.size());
    for (Eigen::Index k = 0; k < z.size(); ++k) {
        Eigen::VectorXd up = z, down = z;
        up[k] += 1e-4, down[k] -= 1e-4;
        const Eigen::VectorXd above = density.residuals(up), below = density.residuals(down);
        if (above.size() > 0 && below.size() > 0)
            out.col(k) = (above - below) / 2e-4;
    }
    return out;
}

/// Levenberg-Marquardt on chi2 + |z|^2: the prior makes the curvature positive. No mass where the model does
/// not exist.
Peak climb(const Density& density, Eigen::VectorXd z) {
    double damping = 1e-3, value = density.at(z);
    Eigen::VectorXd r = density.residuals(z);
    if (r.size() == 0 || !std::isfinite(value))
        return {};
    Eigen::MatrixXd j = slopes(density, z, r.size()), curvature;
    const Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(z.size(), z.size());
    for (int step = 0; step < 60 && damping < 1e8; ++step) {
        curvature = j.transpose() * j + matrix;
        Eigen::MatrixXd damped = curvature;
        damped.diagonal() *= 1.0 + damping;
        const Eigen::VectorXd next = z - damped.ldlt().solve(j.transpose() * r + z);
        const double there = density.at(next), gain = there - value;
        if (!(gain > 0.0)) {
            damping *= 10.0;
            continue;
        }
        z = next, value = there, r = density.residuals(z), damping *= 0.1;
        j = slopes(density, z, r.size());
        if (gain < 1e-6)
            break;
    }
    curvature = j.transpose() * j + matrix;
    const Peak peak{z, curvature.inverse(), value - 0.5 * std::log(curvature.determinant())};
    if (peak.covariance.llt().info() == Eigen::Success && std::isfinite(peak.log_mass))
        return peak;
    // Data that fix one direction 1e8 times better than another: the prior makes every eigenvalue 1 at least,
    // which rounding of the great ones hides.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(curvature);
    const Eigen::VectorXd stiffness = axes.eigenvalues().cwiseMax(1.0);
    return {z, axes.eigenvectors() * stiffness.cwiseInverse().asDiagonal() * axes.eigenvectors().transpose(),
            value - 0.5 * stiffness.array().log().sum()};
}

} // namespace

Mixture peaks(const Density& density, const Eigen::VectorXd& from, const PosteriorMethod& method) {
    constexpr std::size_t searches = 12;
    constexpr double negligible = 10.0; // e^-10 of the greatest mass
    constexpr double greatest = 1e12;   // of a logarithm in which rounding leaves differences of 1e-3
    std::vector<Peak> found(searches + 1);
    parallel_for(found.size(), method.threads, [&](std::size_t i) {
        if (i == 0) {
            found[i] = climb(density, from);
            return;
        }
        if (method.stop_requested && method.stop_requested())
            return;

        // The other searches begin at the first of a few draws from the prior where the model exists.
        RandomStream random(method.seed, static_cast<std::uint32_t>(i), of_search);
        for (int trial = 0; trial < 10; ++trial) {
            const Eigen::VectorXd z = normal_draws(random, density.size());
            if (std::isfinite(density.at(z))) {
                found[i] = climb(density, z);
                return;
            }
        }
    });
    std::ranges::stable_sort(found, std::ranges::greater(), &Peak::log_mass);
    const double most = found.front().log_mass;
    if (!std::isfinite(most))
        throw RunError("posterior: the model does not exist where the fit ended, within the priors; give "
                       "priors that hold places with a model");
    if (std::abs(most) > greatest)
        throw RunError(fmt::format(
            "posterior: the data lie too far from the model for their standard errors: the log likelihood is "
            "{:.2g} where it is greatest, and rounding hides its differences; look for outliers and wrong "
            "units in the data, or give greater standard errors",
            most));
    std::vector<Peak> kept;
    for (const Peak& peak : found)
        if (peak.log_mass > most - negligible && kept.size() < most_peaks &&
            std::ranges::none_of(kept, [&](const Peak& other) {
                const Eigen::VectorXd apart = peak.z - other.z;
                return apart.dot((peak.covariance + other.covariance).ldlt().solve(apart)) <
                       4.0 * static_cast<double>(apart.size());
            }))
            kept.push_back(peak);
    std::vector<Mixture::MixtureComponent> parts;
    for (const Peak& peak : kept)
        parts.push_back({std::exp(peak.log_mass - most), peak.z, peak.covariance});
    return Mixture(std::move(parts));
}

double curvature_evidence(const Problem& problem, const std::vector<Prior>& priors,
                          std::span<const double> from) {
    const Density density(problem, priors);
    if (density.size() == 0)
        return density.log_likelihood({});
    return climb(density, density.coordinates(from)).log_mass +
           static_cast<double>(density.size()) * log_root_2pi;
}

} // namespace rodwake::fitting
