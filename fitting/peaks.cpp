#include "chains.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

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
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(z.size(), z.size());
    for (int step = 0; step < 60 && damping < 1e8; ++step) {
        curvature = j.transpose() * j + one;
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
    curvature = j.transpose() * j + one;
    return {z, curvature.inverse(), value - 0.5 * std::log(curvature.determinant())};
}

/// The first few draws from the prior where the model exists.
Peak from_prior(const Density& density, const PosteriorMethod& method, std::uint32_t number) {
    RandomStream random(method.seed, number, of_search);
    for (int trial = 0; trial < 10; ++trial) {
        const Eigen::VectorXd z = normal_draws(random, density.size());
        if (std::isfinite(density.at(z)))
            return climb(density, z);
    }
    return {};
}

bool same(const Peak& a, const Peak& b) {
    const Eigen::VectorXd apart = a.z - b.z;
    return apart.dot((a.covariance + b.covariance).ldlt().solve(apart)) <
           4.0 * static_cast<double>(apart.size());
}

} // namespace

Mixture peaks(const Density& density, const Eigen::VectorXd& from, const PosteriorMethod& method) {
    constexpr std::size_t searches = 12;
    constexpr double negligible = 10.0; // e^-10 of the greatest mass
    std::vector<Peak> found(searches + 1);
    parallel_for(found.size(), method.threads, [&](std::size_t i) {
        if (i == 0)
            found[i] = climb(density, from);
        else if (!method.stop_requested || !method.stop_requested())
            found[i] = from_prior(density, method, static_cast<std::uint32_t>(i));
    });
    std::ranges::stable_sort(found, std::ranges::greater(), &Peak::log_mass);
    const double most = found.front().log_mass;
    if (!std::isfinite(most))
        throw RunError("posterior: the model does not exist where the fit ended, within the priors; give "
                       "priors that hold places with a model");
    std::vector<Peak> kept;
    for (const Peak& peak : found)
        if (peak.log_mass > most - negligible && kept.size() < most_peaks &&
            std::ranges::none_of(kept, [&](const Peak& other) { return same(peak, other); }))
            kept.push_back(peak);
    std::vector<Mixture::Part> parts;
    for (const Peak& peak : kept)
        parts.push_back({std::exp(peak.log_mass - most), peak.z, peak.covariance});
    return Mixture(std::move(parts));
}

} // namespace rodwake::fitting
