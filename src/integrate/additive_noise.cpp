#include "rodwake/integrate/additive_noise.hpp"

#include <cmath>
#include <numbers>

namespace rodwake::integrate {

double uniform_of(std::uint32_t low, std::uint32_t high) {
    const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32) | low;
    return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

Normals normals_of(const std::array<std::uint32_t, 4>& bits) {
    const double radius = std::sqrt(-2.0 * std::log(uniform_of(bits[0], bits[1])));
    const double angle = 2.0 * std::numbers::pi * uniform_of(bits[2], bits[3]);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

// a = z - h w/2 is independent of w and has the variance s^2 h^3/12.
PathIncrement draw_increment(double h, double strength, const Normals& n) {
    const double w = strength * std::sqrt(h) * n[0];
    return {w, 0.5 * h * w + strength * std::sqrt(h * h * h / 12.0) * n[1]};
}

// With q = h/2, d = w1 - w2 and a = z - h w/2 of the whole and of each half: a = a1 + a2 + q d/2. Given a, d
// has the mean 3 a/(2 q) and the variance s^2 q/2; a1 + a2 follows; a1 - a2, of variance s^2 q^3/6, is
// independent of all.
std::pair<PathIncrement, PathIncrement> halves(const PathIncrement& whole, double h, double strength,
                                               const Normals& n) {
    const double q = 0.5 * h, a = whole.z - q * whole.w;
    const double d = 1.5 * a / q + strength * std::sqrt(0.5 * q) * n[0];
    const double sum = a - 0.5 * q * d, difference = strength * std::sqrt(q * q * q / 6.0) * n[1];
    const double w1 = 0.5 * (whole.w + d), w2 = 0.5 * (whole.w - d);
    return {{w1, 0.5 * (sum + difference) + 0.5 * q * w1}, {w2, 0.5 * (sum - difference) + 0.5 * q * w2}};
}

AdditiveNoiseStep::AdditiveNoiseStep(Rates rates, std::size_t size)
    : rates_(std::move(rates)), stage_(size), k2_(size), k3_(size), k4_(size) {}

void AdditiveNoiseStep::take(std::span<double> y, State k1, double h, std::span<const PathIncrement> noise) {
    const auto stage = [&](double share, State k, double by_z, double by_w, std::span<double> rate) {
        for (std::size_t i = 0; i < y.size(); ++i)
            stage_[i] = y[i] + share * h * k[i] + by_z / h * noise[i].z + by_w * noise[i].w;
        rates_(stage_, rate);
    };
    stage(0.5, k1, 1.5, 0.0, k2_);
    stage(0.5, k2_, 1.5, -0.5, k3_);
    stage(1.0, k3_, 0.0, 1.0, k4_);
    for (std::size_t i = 0; i < y.size(); ++i)
        y[i] += h / 6.0 * (k1[i] + 2.0 * (k2_[i] + k3_[i]) + k4_[i]) + noise[i].w;
}

} // namespace rodwake::integrate
