#include "own_response.hpp"

#include "rods/interaction.hpp"
#include "rodwake/core/error.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace rodwake::medium {

namespace {

using Number = std::complex<double>;
constexpr Number i{0.0, 1.0};
constexpr double most_fit_error = 0.02; // some 1e-4 is usual

/// A(tau) at given times, by the midpoint rule in x of q = 8 x^2/w and in y of phi = pi/2 (1 - y^2): the
/// other quarters of the circle make the same real part. Error: some 1e-5 of the largest A for alpha w up
/// to 10. `along`: (1 + eta)/alpha, `across`: 1/alpha.
Eigen::VectorXd kernel_at(const Eigen::VectorXd& times, double along, double across, double width,
                          const rods::Couplings& couplings) {
    const auto& [kappa, gamma1, gamma2] = couplings;
    constexpr int rings = 160, nodes = 96; // of a quarter of a ring
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(times.size());
    for (int ring = 0; ring < rings; ++ring) {
        const double x = (ring + 0.5) / rings, q = 8.0 * x * x / width, dq = 16.0 * x / (width * rings);
        const double weight =
            across * q * dq / (2.0 * std::numbers::pi) * std::exp(-0.5 * width * width * q * q);
        for (int k = 0; k < nodes; ++k) {
            const double y = (k + 0.5) / nodes, phi = 0.5 * std::numbers::pi * (1.0 - y * y);
            const double c = std::cos(phi), s = std::sin(phi), dphi = 2.0 * y / nodes;
            const Number l = i * kappa * q * c * s - (gamma1 + gamma2) * q * q * s;
            const Number t = 0.5 * i * kappa * q * (c * c - s * s) - gamma1 * q * q * c;
            const Number from_l = -l * s * along * q / (along * q - i * c);
            const Number from_t = t * (-c + i * s * s / (across * q - i * c));
            for (Eigen::Index j = 0; j < times.size(); ++j) {
                const double tau = times[j];
                const Number parts =
                    from_l * std::exp(-along * q * q * tau) + from_t * std::exp(-across * q * q * tau);
                sum[j] += weight * dphi *
                          (parts.real() * std::cos(q * c * tau) - parts.imag() * std::sin(q * c * tau));
            }
        }
    }
    return sum;
}

/// From `first` to `last` in equal ratios.
Eigen::VectorXd geometric(double first, double last, Eigen::Index count) {
    return Eigen::ArrayXd::LinSpaced(count, std::log(first), std::log(last)).exp();
}

} // namespace

OwnResponse::OwnResponse(const elastic::Medium& elastic, const DynamicMedium& medium,
                         const rods::Couplings& couplings, const ModalField& modes)
    : steady_(medium.start == Start::steady) {
    decay_.fill(1.0);
    decay_[terms] = modes.qx[1] * modes.qx[1] * elastic.xi;
    if (!couplings.any())
        return;
    fit(elastic, medium, couplings);
    if (!steady_)
        return;

    // The harmonics by which a rod's images turn it.
    constexpr int headings = 24;
    harmonics_.assign(headings - 1, 0.0);
    for (int j = 0; j < headings; ++j) {
        const double theta = (j + 0.5) * 0.25 * std::numbers::pi / headings;
        std::vector<double> field(modes.numbers());
        modes.add_steady({0.0, 0.0, theta}, field);
        const double turning =
            rods::turning_rate(modes.at(0.0, 0.0, rods::request_of(couplings, false), field), couplings,
                               {std::cos(theta), std::sin(theta)});
        for (int k = 1; k < headings; ++k)
            harmonics_[static_cast<std::size_t>(k - 1)] +=
                2.0 / headings * turning * std::sin(k * std::numbers::pi * (j + 0.5) / headings);
    }
}

void OwnResponse::fit(const elastic::Medium& elastic, const DynamicMedium& medium,
                      const rods::Couplings& couplings) {
    constexpr Eigen::Index samples = 72;
    const double along = (1.0 + elastic.eta) * elastic.xi, width = medium.force_width;
    // Before the first of these times A has not yet begun to change, after the last it has died away.
    const Eigen::VectorXd times =
        geometric(0.02 * width / (1.0 + along / width), std::max(12.0 * width, 60.0 * along), samples);
    // It decays by diffusion, as e^(-tau/(4 D)), and while the rod walks off by w; and no faster than these.
    const Eigen::VectorXd decays =
        geometric(std::min(0.15 / along, 0.7 / width), 3.0 / width + 6.0 * along / (width * width), terms);
    const Eigen::VectorXd wanted = times.cwiseProduct(kernel_at(times, along, elastic.xi, width, couplings));
    Eigen::MatrixXd exponentials(samples, static_cast<Eigen::Index>(terms));
    for (Eigen::Index row = 0; row < samples; ++row)
        exponentials.row(row) = times[row] * (-times[row] * decays.array()).exp().matrix().transpose();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-7); // no large numbers of either sign that cancel
    solver.compute(exponentials);
    const Eigen::VectorXd strengths = solver.solve(wanted);
    fit_error_ = (exponentials * strengths - wanted).norm() / wanted.norm();
    if (!(fit_error_ < most_fit_error))
        throw InputError(fmt::format("self_field = false with the mesh: what a rod's own field does to it is "
                                     "known to {:.1g} only; take self_field = true, or sums for fewer rods",
                                     fit_error_));
    std::ranges::copy(decays, decay_.begin());
    std::ranges::copy(strengths, strength_.begin());
}

void OwnResponse::start(integrate::State poses, std::span<double> state) const {
    const std::size_t rods = poses.size() / 3;
    for (std::size_t k = 0; k < kept; ++k) {
        const double whole = steady_ ? 1.0 / decay_[k] : 0.0;
        for (std::size_t rod = 0; rod < rods; ++rod)
            state[rod * kept + k] = whole * poses[3 * rod + 2];
        state[rods * kept + k] = whole;
    }
}

double OwnResponse::turning(integrate::State poses, std::size_t rod, std::span<const double> state) const {
    const std::size_t rods = poses.size() / 3;
    double sum = 0.0;
    for (std::size_t k = 0; k < terms; ++k)
        sum += strength_[k] * (poses[3 * rod + 2] * state[rods * kept + k] - state[rod * kept + k]);
    const double heading = decay_[terms] * state[rod * kept + terms]; // that the images follow
    double images = 0.0;
    for (std::size_t k = 0; k < harmonics_.size(); ++k)
        images += harmonics_[k] * std::sin(4.0 * static_cast<double>(k + 1) * heading);
    return sum + images;
}

void OwnResponse::advance(std::size_t stage, double h, const std::array<integrate::State, 4>& stages,
                          std::span<const double> from, std::span<double> to) const {
    const std::size_t rods = stages[0].size() / 3;
    for (std::size_t k = 0; k < kept; ++k) {
        const DecayWeights weights = decay_weights(decay_[k], h);
        const double left = stage < 3 ? weights.half : weights.full;
        for (std::size_t rod = 0; rod < rods; ++rod) {
            std::array<double, 4> headings{};
            for (std::size_t j = 0; j < std::min<std::size_t>(stage, 4); ++j)
                headings[j] = stages[j][3 * rod + 2];
            to[rod * kept + k] = left * from[rod * kept + k] + weighted(stage, weights.force, headings);
        }
        to[rods * kept + k] =
            left * from[rods * kept + k] + weighted(stage, weights.force, {1.0, 1.0, 1.0, 1.0});
    }
}

double OwnResponse::slow() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < terms; ++k)
        sum += strength_[k] / (decay_[k] * decay_[k]);
    return sum;
}

} // namespace rodwake::medium
