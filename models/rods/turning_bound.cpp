#include "turning_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

namespace {

/// Bounds of e^z K_n(z): K0 < K_(1/2), K1 < min(1/z, K_(3/2)), and K2 = K0 + 2 K1/z.
struct ScaledBounds {
    double k0, k1, k2;
};

ScaledBounds scaled_bounds(double z) {
    const double half = std::sqrt(0.5 * std::numbers::pi / z);
    const double k1 = z < 1.0 ? std::min(std::exp(z) / z, half * (1.0 + 1.0 / z)) : half * (1.0 + 1.0 / z);
    return {half, k1, half + 2.0 * k1 / z};
}

/// What lies within a relative width of a place, lengths in 2 xi.
struct Around {
    double s, least, stretch, turn; ///< |s|, smallest Re s, |z|/Re z, |e^(i theta)| at most
    double depth;                   ///< Re(s + X) at least

    Around(double r, double w, double k) {
        s = r * (1.0 + k);
        least = r * (1.0 - k) * std::sqrt(1.0 - k * k);
        stretch = s / least;
        turn = std::sqrt((1.0 + k) / (1.0 - k));
        const double sigma = 2.0 * std::sqrt(r) * (1.0 - std::sqrt(1.0 - k));
        depth = w - std::sqrt(2.0 * w) * sigma - 0.5 * sigma * sigma;
    }
};

/// |d G|, |d^2 G|, and the part of d^2 G that does not cancel near the rod.
struct LadderBounds {
    double one, two, rest;
};

LadderBounds ladder_bounds(double a, const Around& around) {
    const ScaledBounds k = scaled_bounds(a * around.least);
    const double decay = std::exp(-a * around.depth), q = around.turn, b = 0.5 * a;
    return {b * decay * (k.k0 + q * k.k1), b * b * decay * (k.k0 + q * (2.0 * k.k1 + q * k.k2)),
            b * b * decay * ((1.0 + q * q) * k.k0 + 2.0 * q * k.k1)};
}

/// |H_T - H_L|, H_a = e^(-a X) a s K1(a s), over |s|^2/2.
double core_bound(double nu, const Around& around) {
    const double largest = std::max(1.0, nu), z = largest * around.least;
    const ScaledBounds k = scaled_bounds(z);
    const double decay = std::max(std::exp(-around.depth), std::exp(-nu * around.depth));
    const double change = std::abs(1.0 - nu) * decay * around.s * around.stretch * z * (k.k0 + k.k1);
    const double least = around.s / around.stretch; // Re s, below |s|
    return 0.5 * around.turn * around.turn * change / (least * least);
}

} // namespace

TurningBound::TurningBound(const elastic::Medium& medium, const Couplings& couplings)
    : c_shear_(0.5 / medium.xi), nu_(medium.nu()) {
    const auto& [kappa, gamma1, gamma2] = couplings;
    kappa_ = std::abs(kappa) * 0.5 * std::numbers::inv_pi * c_shear_;
    laplacian_ = std::abs(gamma1) * std::numbers::inv_pi * c_shear_ * c_shear_;
    gradient_ = (std::abs(gamma1) + std::abs(gamma2)) * std::numbers::inv_pi * c_shear_ * c_shear_;
}

TurningBound::Value TurningBound::at(double distance, double ahead, double width) const {
    const Around around(c_shear_ * distance, c_shear_ * ahead, width);
    const LadderBounds t = ladder_bounds(1.0, around), l = ladder_bounds(nu_, around);
    const double plain = t.two + l.two, near = t.rest + l.rest + core_bound(nu_, around);
    const double phase = 1.0 + width;
    const double polar = laplacian_ * (t.one + t.two) + gradient_ * nu_ * (l.two + nu_ * l.one);
    const double apolar = kappa_ * phase * phase;
    return {apolar * (t.one + std::min(plain, near)) + phase * polar,
            apolar * (t.one + plain) + phase * polar};
}

/// Where exp(-a depth)/width^5 is least: bounds of derivatives go by it.
double TurningBound::suitable_width(double distance, double ahead) const {
    constexpr double widest = 0.4, power = 5.0;
    const double w = c_shear_ * ahead, r = c_shear_ * distance;
    return std::min(widest, (std::sqrt(2.0 * w + 4.0 * power / std::max(1.0, nu_)) - std::sqrt(2.0 * w)) /
                                (2.0 * std::sqrt(r)));
}

} // namespace rodwake::rods
